// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/hidden_place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "pipeline/carried/carried_pixels.hpp"

namespace emberfold::pipeline {

namespace {

using graph::Point;

constexpr int kDirections = 8;
constexpr std::array kTimes = {-61, -43, -31, -22, -15, -10, -6, 6, 10, 15, 22, 31, 43, 61};  // frames
constexpr int kLookAhead = 5;         // frames for which the place must stay free of strokes
constexpr double kStroke = 40;        // grey levels of misfit for a stroke at such a place
constexpr std::size_t kSampled = 10;  // patches that are examined
constexpr double kAround = 3;         // px beyond a patch's reach, where its surroundings are compared

bool inside(const cv::Mat& frame, Point at) {
  return at.x >= 0 && at.y >= 0 && at.x <= frame.cols - 1 && at.y <= frame.rows - 1;
}

double misfit(const SeenClip& clip, int t, std::span<const graph::Patch> patches, const HiddenPlace& place) {
  const std::size_t step = std::max<std::size_t>(1, patches.size() / kSampled);
  const int other = place.frame(t, clip.size());
  const int ahead = place.frame(std::min(t + kLookAhead, clip.size() - 1), clip.size());
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < patches.size(); i += step, ++count) {
    const Point at = patches[i].position, from = at + place.beside;
    if (!inside(clip.frame(t), from) && inside(clip.frame(t), at)) sum += 2 * kStroke;
    sum += kStroke * ((clip.occupied(other, from) ? 1.0 : 0.0) + (clip.occupied(ahead, from) ? 0.5 : 0.0));
    sum += unlikeness_around(clip, patches[i], at, t, place.beside, other);
  }
  return sum / std::max(1, count);
}

}  // namespace

int HiddenPlace::frame(int t, int size) const {
  if (later == 0 || size < 2) return t;
  const int period = 2 * (size - 1), at = ((t + later) % period + period) % period;
  return at < size ? at : period - at;
}

double unlikeness_around(const SeenClip& clip, const graph::Patch& patch, Point at, int t, Point beside,
                         int other) {
  const Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
  const double away = carried_reach(patch) + kAround;
  const int channels = clip.frame(t).channels();
  double sum = 0;
  for (const double side : {-away, away}) {
    const Point place = at + normal * side;
    const auto *a = clip.pixel(t, place), *b = clip.pixel(other, place + beside);
    for (int c = 0; c < channels; ++c) sum += std::abs(double(a[c]) - double(b[c]));
  }
  return sum / (2.0 * channels);
}

bool shows_strokes(const SeenClip& clip, int t, std::span<const graph::Patch> patches,
                   const HiddenPlace& place) {
  const int other = place.frame(t, clip.size());
  const auto shown = std::ranges::count_if(patches, [&](const graph::Patch& patch) {
    return clip.occupied(other, patch.position + place.beside);
  });
  return 4 * shown > static_cast<std::ptrdiff_t>(patches.size());
}

HiddenPlace find_hidden_place(const SeenClip& clip, int t, std::span<const graph::Patch> patches) {
  double reach = 0;
  for (const auto& patch : patches) reach = std::max(reach, carried_reach(patch));
  std::vector<HiddenPlace> places;
  for (const double distance : {2 * reach + kHidingFeather, 3 * reach + kHidingFeather})
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kDirections;
      places.push_back({Point{std::cos(angle), std::sin(angle)} * distance, 0, 0});
    }
  for (const int later : kTimes)
    if (std::abs(later) < clip.size()) places.push_back({{}, later, 0});
  for (auto& place : places) place.misfit = misfit(clip, t, patches, place);
  return *std::ranges::min_element(places, {}, &HiddenPlace::misfit);
}

}  // namespace emberfold::pipeline
