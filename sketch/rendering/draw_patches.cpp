// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/draw_patches.hpp"

#include "sketch/rendering/curve_bands.hpp"
#include "sketch/rendering/patch_colour.hpp"

namespace emberfold::sketch {

namespace {

using detail::colour, detail::Colour;

/// Profile of a band at one place of its curve; sides as seen along the curve.
struct Profile {
  Colour left{}, middle{}, right{};
  ProfileShape shape;
};

Profile profile(const graph::Patch& patch, bool backwards, int channels) {
  Profile p;
  p.left = colour(backwards ? patch.right : patch.left, channels);
  p.middle = colour(patch.middle, channels);
  p.right = colour(backwards ? patch.left : patch.right, channels);
  p.shape = ProfileShape(patch);
  return p;
}

ProfileShape shape_between(const ProfileShape& a, const ProfileShape& b, double s) {
  ProfileShape shape;
  shape.half_width = interpolate(a.half_width, b.half_width, s);
  shape.blur = interpolate(a.blur, b.blur, s);
  return shape;
}

void add(const Profile& a, const Profile& b, const Projection& at, double weight, int channels, float* sum) {
  const ProfileShape::Reached reached = shape_between(a.shape, b.shape, at.s).at(at.distance);
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
    const auto mixed = [&](const Colour Profile::*level) {
      return interpolate((a.*level)[c], (b.*level)[c], at.s);
    };
    sum[c] += static_cast<float>(
        weight * reached.level(mixed(&Profile::left), mixed(&Profile::middle), mixed(&Profile::right)));
  }
}

void add(float a, float b, double s, double weight, float* sum) {
  *sum += static_cast<float>(weight * interpolate(double{a}, double{b}, s));
}

/// Divides the sums of each pixel, `count` of them, by its weight.
void divide(const PatchPlanes& planes, float* sums, std::size_t count) {
  const auto pixels =
      static_cast<std::size_t>(planes.size.width) * static_cast<std::size_t>(planes.size.height);
  for (std::size_t i = 0; i < pixels; ++i)
    if (planes.weights[i] > 0)
      for (std::size_t c = 0; c < count; ++c) sums[i * count + c] /= planes.weights[i];
}

}  // namespace

void draw_patches(const graph::AttributeGraph& graph, PatchValues values, const PatchPlanes& planes) {
  const int channels = planes.channels;
  for (const Band& band : make_bands(graph, planes.cores)) {
    const Profile a = profile(graph.patch(band.a.vertex), band.a.backwards, channels);
    const Profile b = profile(graph.patch(band.b.vertex), band.b.backwards, channels);
    visit_band(band, planes.size, [&](int x, int y, const Projection& at) {
      const double w = band_weight(band, at);
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(planes.size.width) +
                                static_cast<std::size_t>(x);
      add(a, b, at, w, channels, planes.levels + pixel * static_cast<std::size_t>(channels));
      if (planes.values != nullptr)
        add(values[band.a.vertex], values[band.b.vertex], at.s, w, planes.values + pixel);
      planes.weights[pixel] += static_cast<float>(w);
      planes.mask[pixel] = 255;
    });
  }
  divide(planes, planes.levels, static_cast<std::size_t>(channels));
  if (planes.values != nullptr) divide(planes, planes.values, 1);
}

}  // namespace emberfold::sketch
