// SPDX-License-Identifier: Apache-2.0
#include "sketch/dictionary/dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/math/luma.hpp"
#include "sketch/dictionary/patch_views.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/rendering/curve_bands.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kTolerance = 1e-3;     // of means and products that should be 0 or 1
constexpr double kLeastLikeness = 0.2;  // amplitude by RMS of the view, below which an entry does not fit
constexpr int kNumbers = 5;             // place, orientation, size, level, amplitude

double mean_of(std::span<const float> v) {
  double sum = 0;
  for (const float x : v) sum += double{x};
  return sum / static_cast<double>(v.size());
}

/// Mean of the products.
double product(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{a[i]} * double{b[i]};
  return sum / static_cast<double>(a.size());
}

/// Empty, or what is wrong with an entry by itself.
std::string complaint(const DictionaryEntry& entry) {
  const std::size_t size = entry.window() ? kWindowSide * kWindowSide : kProfileSamples;
  if (entry.degree < 0 || entry.degree > 4) return "has a degree that is not 0 to 4";
  if (graph::name(entry.type).empty()) return "has no type";
  if (entry.seen < 1) return "was seen never";
  if (!(entry.residual >= 0 && entry.residual <= 2)) return "has a residual that is not 0 to 2";
  if (entry.components.size() > kMostComponents || entry.spread.size() != entry.components.size())
    return "has more than 4 components, or not as many spreads";
  const auto fits = [&](std::span<const float> v) {
    return v.size() == size && std::ranges::all_of(v, [](float x) { return std::isfinite(x); }) &&
           std::abs(mean_of(v)) <= kTolerance && std::abs(product(v, v) - 1) <= kTolerance;
  };
  if (!fits(entry.mean)) return "has a mean that is not of the mean 0 and the RMS 1";
  for (std::size_t k = 0; k < entry.components.size(); ++k) {
    const double above = k == 0 ? 1e6 : entry.spread[k - 1];
    if (!(entry.spread[k] >= 0 && entry.spread[k] <= above)) return "has spreads that do not fall";
    if (!fits(entry.components[k])) return "has a component that is not of the mean 0 and the RMS 1";
    bool apart = std::abs(product(entry.components[k], entry.mean)) <= kTolerance;
    for (std::size_t j = 0; j < k; ++j)
      apart = apart && std::abs(product(entry.components[k], entry.components[j])) <= kTolerance;
    if (!apart) return "has components that are not orthogonal";
  }
  return {};
}

bool same_group(const DictionaryEntry& a, const DictionaryEntry& b) {
  return a.degree == b.degree && a.type == b.type;
}

bool in_order(const DictionaryEntry& a, const DictionaryEntry& b) {
  if (a.degree != b.degree) return a.degree < b.degree;
  if (a.type != b.type) return a.type < b.type;
  return a.seen >= b.seen;
}

double luma_of(const graph::Level& level) {
  return core::luma(double{level[0]}, double{level[1]}, double{level[2]});
}

/// RMS of what the patch's own profile leaves of its view.
double parametric_residual(const graph::Patch& patch, const PatchView& view) {
  const ProfileShape shape(patch);
  const double left = luma_of(patch.left), middle = luma_of(patch.middle), right = luma_of(patch.right);
  double sum = 0;
  for (std::size_t i = 0; i < view.luma.size(); ++i) {
    const double d = view.reach * profile_position(i) * (view.reversed ? -1 : 1);
    const double off = double{view.luma[i]} - shape.at(d).level(left, middle, right);
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(view.luma.size()));
}

/// Description of a view by an entry with so many coefficients.
struct Fit {
  double score = 0, cost = 0, squares = 0;  // squares: mean of what is left
  int numbers = 0;
};

std::optional<Fit> best_fit(const DictionaryEntry& entry, double share, const PatchView& view,
                            double variance, double noise) {
  const double amplitude = product(view.luma, entry.mean);
  if (!(amplitude > kLeastLikeness * std::sqrt(variance)) || !(amplitude > 0)) return std::nullopt;
  const double pixels = count_pixels(view), number = 0.5 * std::log1p(pixels);
  const std::size_t most = entry.components.size();
  const double base = kNumbers * number - std::log(share) + std::log1p(static_cast<double>(most));
  Fit now, best;
  now.squares = std::max(variance - amplitude * amplitude, 0.0);
  for (std::size_t k = 0; k <= most; ++k) {
    if (k > 0) {
      const double along = product(view.luma, entry.components[k - 1]);
      now.squares = std::max(now.squares - along * along, 0.0);
    }
    now.numbers = static_cast<int>(k);
    now.cost = base + static_cast<double>(k) * number;
    now.score = pixels * now.squares / (2 * noise * noise) + now.cost;
    if (k == 0 || now.score < best.score) best = now;
  }
  return best;
}

/// Entries that may describe a view, and their shares: those of its degree and type, else all of its kind.
std::vector<std::pair<std::uint32_t, double>> candidates(const Dictionary& dictionary,
                                                         const PatchView& view) {
  std::vector<std::pair<std::uint32_t, double>> own, any;
  double total = 0;
  for (std::uint32_t i = 0; i < dictionary.entries.size(); ++i) {
    const DictionaryEntry& entry = dictionary.entries[i];
    if (entry.window() != looks_like_window(view.type, view.degree)) continue;
    if (entry.degree == view.degree && entry.type == view.type) own.emplace_back(i, entry.share);
    any.emplace_back(i, static_cast<double>(entry.seen));
    total += static_cast<double>(entry.seen);
  }
  if (!own.empty()) return own;
  for (auto& [index, share] : any) share /= total;
  return any;
}

/// The entry's vectors are orthogonal: each number by itself.
void encode_channels(PatchCode& code, const DictionaryEntry& entry, const ColourPatchView& seen) {
  for (std::size_t c = 0; c < 3; ++c) {
    code.level[c] = static_cast<float>(mean_of(seen.channel[c]));
    code.amplitude[c] = static_cast<float>(product(seen.channel[c], entry.mean));
    for (std::size_t k = 0; k < static_cast<std::size_t>(code.numbers); ++k)
      code.coefficients[k][c] = static_cast<float>(product(seen.channel[c], entry.components[k]));
  }
}

PatchCode encode_patch(const cv::Mat& levels, const graph::AttributeGraph& graph, std::size_t vertex,
                       const Dictionary& dictionary, double noise) {
  const graph::Patch& patch = graph.patch(vertex);
  const ColourPatchView seen = view_patch(levels, graph, vertex);
  const PatchView& view = seen.view;
  PatchCode code;
  code.reversed = view.reversed;
  code.parametric_cost = coding_cost(patch, count_pixels(view));
  if (view.luma.empty()) return code;
  if (!looks_like_window(view.type, view.degree)) code.parametric = parametric_residual(patch, view);
  const double mean = mean_of(view.luma);
  double variance = 0;
  for (const float v : view.luma) variance += (double{v} - mean) * (double{v} - mean);
  variance /= static_cast<double>(view.luma.size());
  std::optional<Fit> best;
  for (const auto& [index, share] : candidates(dictionary, view)) {
    const auto fit = best_fit(dictionary.entries[index], share, view, variance, noise);
    if (!fit || (best && fit->score >= best->score)) continue;
    best = fit;
    code.entry = index;
  }
  if (!best) return code;
  code.numbers = best->numbers;
  code.residual = std::sqrt(best->squares);
  code.cost = best->cost;
  encode_channels(code, dictionary.entries[code.entry], seen);
  return code;
}

}  // namespace

void validate(const Dictionary& dictionary) {
  const auto& entries = dictionary.entries;
  const auto fail = [](std::size_t i, const std::string& what) {
    throw core::InputError("dictionary: entry " + std::to_string(i) + " " + what);
  };
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (const std::string what = complaint(entries[i]); !what.empty()) fail(i, what);
    if (i > 0 && !in_order(entries[i - 1], entries[i])) fail(i, "is not in order of degree, type and seen");
    if (i >= kMostEntries && same_group(entries[i], entries[i - kMostEntries]))
      fail(i, "is the seventh of its degree and type; there are at most 6");
    double group = 0;
    for (const DictionaryEntry& other : entries)
      if (same_group(other, entries[i])) group += static_cast<double>(other.seen);
    if (entries[i].share != static_cast<double>(entries[i].seen) / group)
      fail(i, "has a share that does not follow from how often it was seen");
  }
}

std::vector<float> compose_shape(const DictionaryEntry& entry, std::span<const float> coefficients) {
  std::vector<float> shape = entry.mean;
  for (std::size_t k = 0; k < std::min(coefficients.size(), entry.components.size()); ++k)
    for (std::size_t i = 0; i < shape.size(); ++i) shape[i] += coefficients[k] * entry.components[k][i];
  return shape;
}

std::vector<PatchCode> encode(const cv::Mat& levels, const graph::AttributeGraph& graph,
                              const Dictionary& dictionary, double noise) {
  check_levels(levels);
  if (!(noise > 0) || !std::isfinite(noise))
    throw core::InputError("dictionary: the noise is " + std::to_string(noise) + ", must be above 0");
  const graph::AttributeGraph strokes = graph::without_anchors(graph);
  std::vector<PatchCode> codes;
  codes.reserve(strokes.size());
  for (std::size_t i = 0; i < strokes.size(); ++i)
    codes.push_back(encode_patch(levels, strokes, i, dictionary, noise));
  return codes;
}

}  // namespace emberfold::sketch
