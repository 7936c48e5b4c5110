// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/curve_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const cv::Size kFrame{60, 50};

// An arc with a point every 0.7 px; right is the outer side.
sketch::Chain arc(Point centre, double radius, double from, double to, bool closed) {
  sketch::Chain chain;
  chain.closed = closed;
  const int count = static_cast<int>((to - from) * radius / 0.7);
  for (int i = 0; i < count; ++i) {
    const double angle = from + (to - from) * i / count;
    sketch::CreasePoint p;
    p.position = centre + unit(angle) * radius;
    p.theta = angle - std::numbers::pi / 2;
    chain.points.push_back(p);
  }
  return chain;
}

// Pixels of all sections, with how often each was visited.
std::map<int, std::pair<double, int>> pixels_of(sketch::Chain chain, double length, double reach) {
  std::map<int, std::pair<double, int>> found;
  for (const auto& section : sketch::cut_into_sections(chain, length)) {
    std::vector<sketch::CurvePixel> pixels;
    sketch::add_section_pixels(chain, section, reach, kFrame, pixels);
    for (const auto& p : pixels) {
      found[p.index].first = static_cast<double>(p.across);
      ++found[p.index].second;
    }
  }
  return found;
}

}  // namespace

TEST_CASE("Sections share the points of a curve among them, in order") {
  auto chain = arc({30, 25}, 15, 0, 5, false);
  const auto sections = sketch::cut_into_sections(chain, 4);
  CHECK_THAT(static_cast<double>(sections.size()), WithinAbs(15 * 5 / 4.0, 1));
  std::uint32_t next = 0;
  for (const auto& s : sections) {
    CHECK(s.first == next);
    CHECK(s.last > s.first);
    next = s.last;
  }
  CHECK(next == chain.points.size());
}

TEST_CASE("Sections of a closed curve depend neither on its first point nor on its direction") {
  auto chain = arc({30, 25}, 13, 0, 2 * std::numbers::pi, true);
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const double length = norm(chain.points[i].position - Point{40, 18});
    chain.points[i].contrast = 20 - 0.1 * length * length;
  }
  const auto middles = [](sketch::Chain of) {
    std::vector<std::pair<long, long>> found;
    for (const auto& s : sketch::cut_into_sections(of, 5)) {
      Point sum{0, 0};
      for (auto i = s.first; i < s.last; ++i) sum = sum + of.points[i].position;
      sum = sum * (1.0 / (s.last - s.first));
      found.emplace_back(std::lround(1e6 * sum.x), std::lround(1e6 * sum.y));
    }
    std::ranges::sort(found);
    return found;
  };
  const auto expected = middles(chain);
  std::rotate(chain.points.begin(), chain.points.begin() + 31, chain.points.end());
  CHECK(middles(chain) == expected);
  std::ranges::reverse(chain.points);
  CHECK(middles(chain) == expected);
}

TEST_CASE("Every pixel about a circle belongs to one section, at its distance from the circle") {
  const Point centre{30.2, 24.7};
  const double radius = 14, reach = 4;
  const auto found = pixels_of(arc(centre, radius, 0, 2 * std::numbers::pi, true), 4, reach);
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x) {
      const double across = graph::distance({double(x), double(y)}, centre) - radius;
      const auto at = found.find(y * kFrame.width + x);
      if (std::abs(across) > reach + 0.1) CHECK(at == found.end());
      if (std::abs(across) < reach - 0.1) {
        REQUIRE(at != found.end());
        CHECK(at->second.second == 1);
        CHECK_THAT(at->second.first, WithinAbs(across, 0.05));
      }
    }
}

TEST_CASE("Pixels beyond a free end, and outside the frame, are left out") {
  sketch::Chain chain;  // along y = 2 from x = 20 to 40
  for (int i = 0; i <= 20; ++i) {
    sketch::CreasePoint p;
    p.position = {20.0 + i, 2};
    chain.points.push_back(p);
  }
  for (const auto& [index, pixel] : pixels_of(chain, 5, 6)) {
    const int x = index % kFrame.width, y = index / kFrame.width;
    CHECK(x >= 19);
    CHECK(x <= 41);
    CHECK_THAT(pixel.first, WithinAbs(y - 2, 1e-6));
  }
}
