// SPDX-License-Identifier: Apache-2.0
// One frame with two draws of noise: how much of the curve length of either sketch the other has too.
#include <cstdint>
#include <numbers>
#include <span>
#include <string>

#include "sketch/extract.hpp"
#include "tests/bench/figures/measures.hpp"
#include "tests/support/sketch_scene.hpp"

namespace emberfold::figures {

namespace {

constexpr double kNoise = 2, kAcross = 1, kAngle = 10 * std::numbers::pi / 180;

struct Shared {
  double hit = 0, all = 0;
  void operator+=(Shared o) {
    hit += o.hit;
    all += o.all;
  }
  [[nodiscard]] double share() const { return hit / all; }
};

Shared shared(std::span<const Segment> of, std::span<const Segment> with) {
  Shared result;
  for (const Sample& s : samples(of)) {
    result.all += s.length;
    if (runs_along(with, s, kAcross, kAngle)) result.hit += s.length;
  }
  return result;
}

Shared twice(const cv::Mat1f& frame) {
  const auto sketched = [&](std::uint64_t seed) {
    return pieces(sketch::extract(test::with_noise(frame, kNoise, seed), usual_options()), Kind::all);
  };
  const std::vector<Segment> a = sketched(1), b = sketched(2);
  Shared result = shared(a, b);
  result += shared(b, a);
  return result;
}

/// A row for each, and one for all their length together.
class Rows {
 public:
  explicit Rows(std::string kind) : kind_(std::move(kind)) {}
  void add(const std::string& name, Shared found) {
    rows_.push_back({"steadiness: " + name, found.share(), 3, "", {}});
    all_ += found;
  }
  std::vector<Row> finish() {
    rows_.push_back({"steadiness: ALL " + kind_, all_.share(), 3, "", at_least(0.95)});
    return rows_;
  }

 private:
  std::string kind_;
  std::vector<Row> rows_;
  Shared all_;
};

}  // namespace

std::vector<Row> steadiness(const Inputs& inputs) {
  Rows clips("CLIPS"), scenes("SCENES");
  for (const ClipFrame& frame : clip_frames(inputs.clips, {60}))
    clips.add(frame.clip, twice(levels_of(grey_at(frame.pixels))));
  for (const Scene& scene : read_scenes(inputs.scenes, 20, 30, 3)) {
    Shared found;
    for (const SceneFrame& frame : scene.frames) found += twice(levels_of(frame.pixels));
    scenes.add(scene.name, found);
  }
  std::vector<Row> rows = clips.finish(), more = scenes.finish();
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

}  // namespace emberfold::figures
