// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "dytex/surface/polygon.hpp"
#include "tests/dytex/surface/surface_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using Catch::Matchers::WithinAbs;

namespace {

const std::string kPoints = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

std::string refusal(const std::string& text) {
  return test::message_of<core::IoError>([&] { mesh_of(text); });
}

double area_of(const std::vector<cv::Point2d>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) sum += corners[i].cross(corners[(i + 1) % corners.size()]);
  return sum / 2;
}

}  // namespace

TEST_CASE("an OBJ file is read with polygons and minus indices and everything that is passed over") {
  const auto mesh = mesh_of(
      "\t# a comment\r\nmtllib a.mtl\no thing\nv 0 0 0 1\nv +1 0 0 0.5 0.5 0.5\nv 1 1e0 0\r\nv 0 1 .0\n"
      "vn 0 0 1\nvt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\ng a b\nusemtl m\ns 1\n"
      "f 1/1/1 2/2/1 \\\n 3/3/1 -1/-1/1 # four corners\nl 1 2\nf -4/1 -2/3 -1/4");
  CHECK(mesh.points.size() == 4);
  CHECK(mesh.uvs.size() == 4);
  REQUIRE(mesh.triangles.size() == 3);
  CHECK(mesh.triangles[0] == std::array<dytex::UvCorner, 3>{{{0, 0}, {1, 1}, {2, 2}}});
  CHECK(mesh.triangles[1] == std::array<dytex::UvCorner, 3>{{{0, 0}, {2, 2}, {3, 3}}});
  CHECK(mesh.triangles[2] == mesh.triangles[1]);
}

TEST_CASE("points and places that are given twice are one") {
  const auto mesh = mesh_of(
      "v 5 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv -0 1 0\nv 1 1 0\n"
      "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 0\nf 2/1 3/2 4/3\nf 5/4 7/1 6/3\n");
  REQUIRE(mesh.points.size() == 5);
  CHECK(mesh.points[0].x == 5);
  CHECK(mesh.uvs.size() == 3);
  CHECK(mesh.triangles[1] == std::array<dytex::UvCorner, 3>{{{2, 1}, {4, 0}, {3, 2}}});
  std::ostringstream out;
  dytex::write_obj(out, mesh);
  const auto again = mesh_of(out.str());
  CHECK(again.points == mesh.points);
  CHECK(again.uvs == mesh.uvs);
  CHECK(again.triangles == mesh.triangles);
}

TEST_CASE("what is no surface with a texture is refused with its line") {
  const auto refused = [&](const std::string& text, const std::vector<std::string>& what) {
    const std::string told = refusal(text);
    INFO(told);
    CHECK(told.starts_with("mesh.obj: "));
    CHECK(told.find('\n') == std::string::npos);
    for (const auto& part : what) CHECK(contains(told, part));
  };
  refused("", {"no face"});
  refused(kPoints, {"no face"});
  refused(kPoints + "f 1 2 3\n", {"line 7", "\"1\"", "1/1/1"});
  refused(kPoints + "f 1//1 2//1 3//1\n", {"line 7", "\"1//1\""});
  refused(kPoints + "\nf 1/1 2/2 4/3\n", {"line 8", "the point \"4\"", "1 to 3", "-3"});
  refused(kPoints + "f 1/1 2/2 3/-4\n", {"line 7", "texture \"-4\"", "1 to 3"});
  refused(kPoints + "f 1/1 2/2 0/1\n", {"the point \"0\""});
  refused(kPoints + "f 1/1 2/2 3x/1\n", {"the point \"3x\""});
  refused(kPoints + "f 1/1 2/2\n", {"f has 2 values", "3 to 256"});
  refused("f 1/1 1/1 1/1\n", {"line 1", "none before it"});
  refused("v 0 0\n", {"line 1", "v has 2 values"});
  refused("v 0 0 nan\n", {"\"nan\"", "1e12"});
  refused("v 0 0 1e300\n", {"\"1e300\""});
  refused("v 0 0 1,5\n", {"\"1,5\""});
  refused("# one\nvt 0 1e\n", {"line 2", "\"1e\""});
  refused(kPoints + "vt 1.25 0\nf 1/1 2/4 3/3\n", {"line 8", "1.25 0", "0 to 1"});
  refused(kPoints + "curv 0 1\n", {"line 7", "\"curv\""});
  refused("v 0 \\\n0 \\\nx\n", {"line 1", "\"x\""});
  refused("v 0 0 0\n" + std::string(70000, ' '), {"line 2", "64 KiB"});
}

TEST_CASE("a polygon is cut into triangles of its own area") {
  core::Rng rng(3);
  for (int round = 0; round < 40; ++round) {
    std::vector<cv::Point2d> corners;  // a star around 0, in either sense
    const int n = 4 + static_cast<int>(rng.below(12));
    for (int i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * i / n, r = rng.uniform(0.1, 1);
      corners.emplace_back(r * std::cos(turn), (round % 2 == 0 ? r : -r) * std::sin(turn));
    }
    double sum = 0, sizes = 0;
    const auto triangles = dytex::detail::cut_polygon(corners);
    CHECK(triangles.size() == corners.size() - 2);
    for (const auto& [a, b, c] : triangles) {
      const double area = area_of({corners[a], corners[b], corners[c]});
      sum += area, sizes += std::abs(area);
    }
    CHECK_THAT(sum, WithinAbs(area_of(corners), 1e-12));
    CHECK_THAT(sizes, WithinAbs(std::abs(area_of(corners)), 1e-12));
  }
  const std::vector<cv::Point2d> flat(5, cv::Point2d(1, 1));
  CHECK(dytex::detail::cut_polygon(flat).size() == 3);
}
