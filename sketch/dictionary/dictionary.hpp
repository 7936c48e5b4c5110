// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/rendering/render.hpp"

// θ_img of Guo, Zhu & Wu 2007, learned: what the patches of a clip look like, by degree and type.
namespace emberfold::sketch {

/// A profile's samples lie evenly over ±reach, as far to each side of the curve as draw_fitted shows it.
inline constexpr std::size_t kProfileSamples = 33;
/// A window has so many samples a side, over ±reach of a blob, else over ±1.5 reach along and across.
inline constexpr std::size_t kWindowSide = 11;
inline constexpr std::size_t kMostComponents = 4;
inline constexpr std::size_t kMostEntries = 6;  ///< of one degree and type

/// Of a degree (0…4, where 4 stands for more, too) and a type: blobs, corners and whatever has a degree of 3
/// or more look like a window, all others like the profile across them.
inline bool looks_like_window(graph::PatchType type, int degree) {
  return degree >= 3 || type == graph::PatchType::blob || type == graph::PatchType::corner;
}

/// The luma that a frame shows at a patch, bicubic between pixels (the border's beyond it): a profile is
/// averaged over 5 px along the patch; a window is row after row, a row runs across the curve from left to
/// right, the next one lies further along it. The patch's direction is turned by half a turn where grey falls
/// from left to right (Σ d·level < 0), so that it does not matter which way a curve is followed.
struct PatchView {
  graph::VertexId vertex;
  graph::PatchType type = graph::PatchType::ridge;
  int degree = 0;      ///< 0…4
  double reach = 1.5;  ///< px
  bool reversed = false;
  std::vector<float> luma;  ///< kProfileSamples, or kWindowSide²; white = 255
};

/// One for each patch, by index; a patch whose view holds a value that is not finite has no samples.
/// `levels`: CV_32F, 1 or 3 channels, not empty; InputError otherwise. O(patches).
std::vector<PatchView> view_patches(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// What some patches of one degree and type look like: level + amplitude·(mean + Σ cₖ·component k).
struct DictionaryEntry {
  graph::PatchType type = graph::PatchType::ridge;
  int degree = 0;           ///< 0…4
  std::uint64_t seen = 1;   ///< patches that it was learned for, ≥ 1
  double share = 1;         ///< of its degree's and type's patches, 0…1: follows from `seen`
  double residual = 0;      ///< RMS that is left of what has an RMS of 1
  std::vector<float> mean;  ///< its own mean 0, its RMS 1
  /// Like `mean`, each of the RMS 1 and orthogonal to `mean` and each other; at most kMostComponents.
  std::vector<std::vector<float>> components;
  std::vector<double> spread;  ///< SD of each component's coefficient, the greatest first

  [[nodiscard]] bool window() const { return looks_like_window(type, degree); }
  bool operator==(const DictionaryEntry&) const = default;
};

/// Entries by degree, then type, those seen most first.
struct Dictionary {
  std::vector<DictionaryEntry> entries;
  bool operator==(const Dictionary&) const = default;
};

/// InputError, naming the entry, where anything above does not hold.
void validate(const Dictionary& dictionary);

/// Learns a dictionary from views. Holds at most 4096 profiles or 1536 windows of each degree and type, those
/// with the smallest random keys of (seed, frame, vertex): a fair sample, whatever the order of the frames.
class DictionaryLearner {
 public:
  explicit DictionaryLearner(std::uint64_t seed = 0) : seed_(seed) {}

  /// The views of one frame; a frame's number tells its views apart from others'. Even views (RMS below ½
  /// grey level) tell nothing and are passed over.
  void add(std::uint32_t frame, std::span<const PatchView> views);

  /// In each group, level and contrast are taken off each view; k-means (k-means++, the best of 3 starts) for
  /// every k up to kMostEntries; in each cluster principal components. k and the numbers of components are
  /// those with the shortest description, of N views of T independent numbers each (the pixels that they span
  /// on the mean),
  ///   Σ over clusters Nᵢ·(½ Σ ln λₖ + ½ (T − K)·ln σ² − ln share) + ½ ln(Nᵢ)·(K + 1)·(T + 1)
  /// λₖ being the variance of component k, σ² what is left for each other number (at least 10⁻⁴: what is
  /// sampled is not known better), K at most a quarter of Nᵢ: the likelihood of probabilistic PCA, and
  /// Rissanen's cost of its parameters. The same bits at any thread count. Throws core::Cancelled.
  [[nodiscard]] Dictionary learn(const core::Context& context = {}) const;

  [[nodiscard]] std::size_t stored() const;  ///< views in memory

 private:
  using Group = std::pair<int, graph::PatchType>;
  struct Key {
    std::uint64_t random = 0;
    std::uint32_t frame = 0, vertex = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Sample {
    std::uint64_t seen = 0;
    std::map<Key, PatchView> stored;
  };
  std::uint64_t seed_;
  std::map<Group, Sample> groups_;
};

/// A patch as the dictionary tells it.
struct PatchCode {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::uint32_t entry = kNone;  ///< kNone: the dictionary has none that fits, or nothing can be seen
  bool reversed = false;        ///< the entry is seen against the patch's direction
  /// Grey levels of each channel: level + amplitude·mean + Σ coefficientₖ·componentₖ is shown.
  graph::Level level{}, amplitude{};
  std::array<graph::Level, kMostComponents> coefficients{};
  int numbers = 0;                   ///< coefficients that are told; the others are 0
  double residual = 0;               ///< grey levels, RMS of luma over the view
  double cost = 0;                   ///< nats
  std::optional<double> parametric;  ///< residual of a profile's own parameters on the same view
  double parametric_cost = 0;        ///< nats, coding_cost with the same pixels
};

/// For each patch, by index, the entry of its degree and type (of any, where there is none) and the number of
/// coefficients that make squared residual / (2 noise²) + cost least, in luma; level, amplitude and
/// coefficients are those of least squares in each channel: in fire, red is full where green still rises, and
/// no channel is luma on another scale. An entry fits where luma's amplitude is above 0.2 of the view's RMS.
/// The cost is comparable with
/// coding_cost: ½ ln(1 + pixels) nats for each of 5 numbers (place, orientation, size, level, amplitude) and
/// each coefficient, −ln of the entry's share, and ln(K + 1) for their number; pixels are those that the view
/// spans. `levels`: as for views(). `noise`: grey levels, > 0; InputError otherwise.
std::vector<PatchCode> encode(const cv::Mat& levels, const graph::AttributeGraph& graph,
                              const Dictionary& dictionary, double noise);

/// The same pixels as draw_fitted covers, with what the codes say. A patch that looks like a profile shows it
/// along the curve, over to the next patch's; a window is laid over the bands that meet in it, its middle
/// counting most, and they go on into it with the nearest profile. What has no code is drawn from its
/// attributes. `codes`: one for each patch; InputError for another number of them, for an entry that is not
/// there, or for what draw_fitted refuses.
Sketchable draw_learned(const graph::AttributeGraph& graph, std::span<const PatchCode> codes,
                        const Dictionary& dictionary, cv::Size size, int channels);

/// mean + Σ coefficientₖ·componentₖ
std::vector<float> compose_shape(const DictionaryEntry& entry, std::span<const float> coefficients);

/// The format "emberfold.dictionary", version 1. InputError where the dictionary is not valid. Reading the
/// archive gives the same dictionary, bit for bit.
core::ModelArchive to_archive(const Dictionary& dictionary);

/// IoError, naming key or array and what is expected, for a text that is no JSON, another format, a newer
/// version, an array that is missing or has another type or shape, and whatever validate() refuses.
Dictionary read_dictionary(const core::ModelArchive& archive);

}  // namespace emberfold::sketch
