// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/dictionary/dictionary.hpp"
#include "sketch/dictionary/patch_views.hpp"
#include "sketch/rendering/curve_bands.hpp"
#include "sketch/rendering/patch_colour.hpp"

namespace emberfold::sketch {

namespace {

using detail::colour, detail::Colour;

/// Levels across a patch's direction, channel by channel, at profile_position(i) reaches.
using Table = std::array<Colour, kProfileSamples>;

/// A patch's profile along its own direction, and the window over it, if it has one.
struct DecodedPatch {
  Table across{};
  std::vector<Colour> window;
};

Table parametric(const graph::Patch& patch, int channels) {
  const ProfileShape shape(patch);
  const Colour left = colour(patch.left, channels), middle = colour(patch.middle, channels),
               right = colour(patch.right, channels);
  Table table{};
  for (std::size_t i = 0; i < kProfileSamples; ++i) {
    const auto reached = shape.at(profile_reach(patch) * profile_position(i));
    for (std::size_t c = 0; c < 3; ++c) table[i][c] = reached.level(left[c], middle[c], right[c]);
  }
  return table;
}

Colour mixed(const Colour& a, const Colour& b, double s) {
  return {interpolate(a[0], b[0], s), interpolate(a[1], b[1], s), interpolate(a[2], b[2], s)};
}

/// A window's levels at (along, across), −1…1 each.
Colour window_at(const std::vector<Colour>& window, double along, double across) {
  constexpr double kHalf = 0.5 * (kWindowSide - 1);
  const double y = std::clamp((along + 1) * kHalf, 0.0, 2 * kHalf - 1e-9);
  const double x = std::clamp((across + 1) * kHalf, 0.0, 2 * kHalf - 1e-9);
  const auto y0 = static_cast<std::size_t>(y), x0 = static_cast<std::size_t>(x);
  const double fy = y - static_cast<double>(y0), fx = x - static_cast<double>(x0);
  const Colour* at = window.data() + y0 * kWindowSide + x0;
  return mixed(mixed(at[0], at[1], fx), mixed(at[kWindowSide], at[kWindowSide + 1], fx), fy);
}

/// Decodes the levels at each of the entry's samples.
std::vector<Colour> decode(const PatchCode& code, const DictionaryEntry& entry, int channels) {
  const Colour level = colour(code.level, channels), amplitude = colour(code.amplitude, channels);
  std::vector<Colour> all(entry.mean.size());
  const auto numbers = std::min(static_cast<std::size_t>(std::max(code.numbers, 0)), entry.components.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) all[i][c] = level[c] + amplitude[c] * double{entry.mean[i]};
  for (std::size_t k = 0; k < numbers; ++k) {
    const Colour coefficient = colour(code.coefficients[k], channels);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) all[i][c] += coefficient[c] * double{entry.components[k][i]};
  }
  if (code.reversed) std::ranges::reverse(all);
  return all;
}

DecodedPatch decode_patch(const graph::Patch& patch, const PatchCode& code, const Dictionary& dictionary,
                          int channels) {
  if (code.entry == PatchCode::kNone) return {parametric(patch, channels), {}};
  const DictionaryEntry& entry = dictionary.entries[code.entry];
  auto levels = decode(code, entry, channels);
  DecodedPatch result;
  for (std::size_t i = 0; i < kProfileSamples; ++i)
    result.across[i] = entry.window() ? window_at(levels, 0, profile_position(i) / 1.5) : levels[i];
  if (entry.window()) result.window = std::move(levels);
  return result;
}

/// A table's levels at `place` reaches to the right.
Colour at(const Table& table, double place) {
  const double x = std::clamp((place + 1) * 0.5 * (kProfileSamples - 1), 0.0, kProfileSamples - 1 - 1e-9);
  const auto i = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(i);
  return mixed(table[i], table[i + 1], f);
}

/// Drawing in progress.
struct Canvas {
  Sketchable part;
  cv::Mat1f weights;

  void add(int x, int y, const Colour& levels, double weight) {
    const int channels = part.levels.channels();
    float* sum = part.levels.ptr<float>(y) + x * channels;
    for (int c = 0; c < channels; ++c)
      sum[c] += static_cast<float>(weight * levels[static_cast<std::size_t>(c)]);
    weights(y, x) += static_cast<float>(weight);
    part.mask.at<std::uint8_t>(y, x) = 255;
  }
};

void draw_bands(Canvas& canvas, const graph::AttributeGraph& graph, const std::vector<DecodedPatch>& all) {
  for (const Band& band : make_bands(graph)) {
    // A patch with a window has no profile of its own along the curve.
    const auto profile_end = [&](const BandEnd& own, const BandEnd& other) {
      return !all[own.vertex].window.empty() && all[other.vertex].window.empty() ? other : own;
    };
    const BandEnd a = profile_end(band.a, band.b), b = profile_end(band.b, band.a);
    const Table &table_a = all[a.vertex].across, &table_b = all[b.vertex].across;
    visit_band(band, canvas.part.mask.size(), [&](int x, int y, const Projection& foot) {
      const double place = foot.distance / interpolate(band.a.reach, band.b.reach, foot.s);
      const Colour from = at(table_a, a.backwards ? -place : place);
      const Colour to = at(table_b, b.backwards ? -place : place);
      canvas.add(x, y, mixed(from, to, foot.s), band_weight(band, foot));
    });
  }
}

/// Lays a window over the pixels that are drawn already.
void lay_window(Canvas& canvas, const graph::Patch& patch, const std::vector<Colour>& window) {
  const double reach = 1.5 * profile_reach(patch), c = std::cos(patch.theta), s = std::sin(patch.theta);
  const auto [px, py] = patch.position;
  const cv::Size size = canvas.part.mask.size();
  PixelRange rows{0, size.height - 1}, columns{0, size.width - 1};
  rows.intersect(1, -py, -reach, reach);
  columns.intersect(1, -px, -reach, reach);
  for (int y = rows.first; y <= rows.last; ++y)
    for (int x = columns.first; x <= columns.last; ++x) {
      if (canvas.part.mask.at<std::uint8_t>(y, x) == 0) continue;
      const double dx = x - px, dy = y - py, inward = 1 - std::hypot(dx, dy) / reach;
      if (inward <= 0) continue;
      canvas.add(x, y, window_at(window, (dx * c + dy * s) / reach, (dy * c - dx * s) / reach),
                 4 * inward * inward);
    }
}

void draw_blobs(Canvas& canvas, const graph::AttributeGraph& graph, const std::vector<DecodedPatch>& all) {
  const int channels = canvas.part.levels.channels();
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const graph::Patch& blob = graph.patch(i);
    if (graph.degree(i) != 0 || blob.type != graph::PatchType::blob) continue;
    const BlobShape shape(blob);
    const Colour left = colour(blob.left, channels), middle = colour(blob.middle, channels),
                 right = colour(blob.right, channels);
    const double c = std::cos(blob.theta), s = std::sin(blob.theta);
    visit_blob(blob, shape, canvas.part.mask.size(), [&](int x, int y) {
      const double dx = x - blob.position.x, dy = y - blob.position.y;
      Colour levels{};
      if (all[i].window.empty()) {
        const auto shares = shape.at(dx, dy);
        for (std::size_t k = 0; k < 3; ++k)
          levels[k] = shares.left * left[k] + shares.middle * middle[k] + shares.right * right[k];
      } else {
        levels =
            window_at(all[i].window, (dx * c + dy * s) / shape.reach(), (dy * c - dx * s) / shape.reach());
      }
      canvas.add(x, y, levels, blob_weight(shape, dx, dy));
    });
  }
}

void check_codes(const graph::AttributeGraph& graph, std::span<const PatchCode> codes,
                 const Dictionary& dictionary) {
  if (codes.size() != graph.size())
    throw core::InputError("render: " + std::to_string(codes.size()) + " codes for " +
                           std::to_string(graph.size()) + " patches");
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (codes[i].entry == PatchCode::kNone) continue;
    if (codes[i].entry >= dictionary.entries.size() ||
        dictionary.entries[codes[i].entry].window() !=
            looks_like_window(graph.patch(i).type, counted_degree(graph, i)))
      throw core::InputError("render: the code of patch " + std::to_string(i) + " names entry " +
                             std::to_string(codes[i].entry) + ", which the dictionary has not for it");
  }
}

}  // namespace

Sketchable draw_learned(const graph::AttributeGraph& graph, std::span<const PatchCode> codes,
                        const Dictionary& dictionary, cv::Size size, int channels) {
  check_frame(size, channels);
  const graph::AttributeGraph strokes = graph::without_anchors(graph);
  check_codes(strokes, codes, dictionary);
  std::vector<DecodedPatch> all;
  all.reserve(strokes.size());
  for (std::size_t i = 0; i < strokes.size(); ++i)
    all.push_back(decode_patch(strokes.patch(i), codes[i], dictionary, channels));
  Canvas canvas{{cv::Mat(size, CV_32FC(channels), cv::Scalar::all(0)), cv::Mat(size, CV_8U, cv::Scalar(0))},
                cv::Mat1f(size, 0.0F)};
  draw_bands(canvas, strokes, all);
  for (std::size_t i = 0; i < strokes.size(); ++i)
    if (!all[i].window.empty() && strokes.patch(i).type != graph::PatchType::blob)
      lay_window(canvas, strokes.patch(i), all[i].window);
  draw_blobs(canvas, strokes, all);
  for (int y = 0; y < size.height; ++y) {
    float* levels = canvas.part.levels.ptr<float>(y);
    for (int x = 0; x < size.width; ++x)
      if (const float sum = canvas.weights(y, x); sum > 0)
        for (int c = 0; c < channels; ++c) levels[x * channels + c] /= sum;
  }
  return hold_anchors(canvas.part, graph);
}

}  // namespace emberfold::sketch
