// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/flanks.hpp"

#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::AttributeGraph;
using graph::Patch;
using graph::PatchType;

namespace {

// Lines down the frame, each a curve of patches 5 px apart.
class CreaseLines {
 public:
  CreaseLines& line(double x, double width, double contrast, double gain = 100, int patches = 10) {
    for (int i = 0; i < patches; ++i) {
      Patch patch;
      patch.type = width == 0 ? PatchType::step : contrast > 0 ? PatchType::ridge : PatchType::valley;
      patch.position = {x, 20 + 5.0 * i};
      patch.theta = 1.5707963267948966;
      patch.width = width;
      patch.blur = 2;
      patch.contrast = contrast;
      patch.gain = gain;
      if (i > 0) edges_.push_back({{next_ - 1}, {next_}});
      vertices_.push_back({{next_++}, {}, patch});
    }
    return *this;
  }
  [[nodiscard]] AttributeGraph graph() const { return {vertices_, edges_}; }

  // Places of the lines that stay.
  [[nodiscard]] std::vector<double> left() const {
    std::vector<double> xs;
    const AttributeGraph found = sketch::remove_flank_curves(graph(), 0.45);
    for (const auto& v : found.vertices())
      if (xs.empty() || xs.back() != v.patch.position.x) xs.push_back(v.patch.position.x);
    return xs;
  }

 private:
  std::vector<graph::Vertex> vertices_;
  std::vector<graph::Edge> edges_;
  std::uint32_t next_ = 0;
};

using Xs = std::vector<double>;

}  // namespace

TEST_CASE("a wide line beside a narrow one of the other sign is its flank") {
  CHECK(CreaseLines().line(50, 5, 30).line(62, 18, -25).left() == Xs{50});
  CHECK(CreaseLines().line(62, 18, 25).line(50, 5, -30).left() == Xs{50});
  // Whichever comes first.
  CHECK(CreaseLines().line(62, 18, -25).line(50, 5, 30).left() == Xs{50});
}

TEST_CASE("lines that are no flank stay: alone - as narrow - of the same sign - farther off - stronger") {
  CHECK(CreaseLines().line(62, 18, -25).left() == Xs{62});
  CHECK(CreaseLines().line(50, 5, 30).line(58, 5, -25).left() == Xs{50, 58});
  CHECK(CreaseLines().line(50, 5, 30).line(62, 18, 25).left() == Xs{50, 62});
  CHECK(CreaseLines().line(50, 5, 30).line(66, 18, -25).left() == Xs{50, 66});
  CHECK(CreaseLines().line(50, 5, 30).line(62, 18, -40).left() == Xs{50, 62});
}

TEST_CASE("a line that is beside another for less than two patches in five stays") {
  CHECK(CreaseLines().line(50, 5, 30, 100, 3).line(62, 18, -25, 100, 12).left() == Xs{50, 62});
  CHECK(CreaseLines().line(50, 5, 30, 100, 6).line(62, 18, -25, 100, 12).left() == Xs{50});
}

TEST_CASE("a step at the side of a line is its flank where it saves less than the line") {
  CHECK(CreaseLines().line(50, 5, 30, 100).line(56, 0, 40, 50).left() == Xs{50});
  CHECK(CreaseLines().line(50, 5, 30, 100).line(56, 0, 40, 90).left() == Xs{50, 56});
  CHECK(CreaseLines().line(50, 5, 30, 100).line(56, 0, 80, 50).left() == Xs{50, 56});
  CHECK(CreaseLines().line(50, 5, 30, 100).line(70, 0, 40, 50).left() == Xs{50, 70});
}

TEST_CASE("what is a flank of a flank is judged by what stays") {
  // The wide valley goes; the wider ridge beside it had only the valley to be a flank of.
  CHECK(CreaseLines().line(50, 5, 30).line(62, 18, -25).line(86, 30, 24).left() == Xs{50, 86});
}

TEST_CASE("a graph without flanks is given back as it is - and an empty one") {
  const AttributeGraph graph = CreaseLines().line(50, 5, 30).line(100, 18, -25).graph();
  CHECK(sketch::remove_flank_curves(graph, 0.45) == graph);
  CHECK(sketch::remove_flank_curves({}, 0.45).empty());
}
