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

// A learned θ_img of Guo, Zhu & Wu 2007: the appearance of the patches of a clip, by degree and type.
namespace emberfold::sketch {

/// Samples of a profile, evenly over ±reach, as far to each side of the curve as draw_fitted shows it.
inline constexpr std::size_t kProfileSamples = 33;
/// Samples of a window's side, over ±reach of a blob, else over ±1.5 reach along and across.
inline constexpr std::size_t kWindowSide = 11;
inline constexpr std::size_t kMostComponents = 4;  ///< of an entry
inline constexpr std::size_t kMostEntries = 6;     ///< of one degree and type

/// Returns whether patches of this degree (0…4, 4 for more, too) and type look like a window. Those are
/// blobs, corners and all of degree 3 or more; all others look like the profile across them.
inline bool looks_like_window(graph::PatchType type, int degree) {
  return degree >= 3 || type == graph::PatchType::blob || type == graph::PatchType::corner;
}

/// Holds the luma that a frame shows at a patch, bicubic between pixels. A profile is averaged over 5 px
/// along the patch. A window is row after row; a row runs across the curve from left to right, the next one
/// lies further along it. Where grey falls from left to right (Σ d·level < 0) the view is reversed by half a
/// turn, so that the direction in which a curve is followed does not matter.
struct PatchView {
  graph::VertexId vertex;
  graph::PatchType type = graph::PatchType::ridge;
  int degree = 0;      ///< 0…4
  double reach = 1.5;  ///< px
  bool reversed = false;
  std::vector<float> luma;  ///< kProfileSamples, or kWindowSide²; white = 255
};

/// Returns the view of each patch, by index. A view that holds a value that is not finite has no samples.
/// `levels`: CV_32F, 1 or 3 channels, not empty; throws core::InputError otherwise. O(patches).
std::vector<PatchView> view_patches(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// Holds the appearance of some patches of one degree and type: level + amplitude·(mean + Σ cₖ·component k).
struct DictionaryEntry {
  graph::PatchType type = graph::PatchType::ridge;
  int degree = 0;           ///< 0…4
  std::uint64_t seen = 1;   ///< number of patches that it was learned for, ≥ 1
  double share = 1;         ///< of the patches of its degree and type, 0…1: follows from `seen`
  double residual = 0;      ///< RMS that the components leave of views of RMS 1
  std::vector<float> mean;  ///< its own mean 0, its RMS 1
  /// Like `mean`, each of the RMS 1 and orthogonal to `mean` and each other; at most kMostComponents.
  std::vector<std::vector<float>> components;
  std::vector<double> spread;  ///< SD of each component's coefficient, the greatest first

  [[nodiscard]] bool window() const { return looks_like_window(type, degree); }
  bool operator==(const DictionaryEntry&) const = default;
};

/// Holds entries ordered by degree, then type, the most frequent first.
struct Dictionary {
  std::vector<DictionaryEntry> entries;
  bool operator==(const Dictionary&) const = default;
};

/// Checks a dictionary. Throws core::InputError, naming the entry, where a statement above does not hold.
void validate(const Dictionary& dictionary);

/// Learns a dictionary from views. Holds at most 4096 profiles or 1536 windows of each degree and type, those
/// with the smallest random keys of (seed, frame, vertex): a fair sample, whatever the order of the frames.
class DictionaryLearner {
 public:
  explicit DictionaryLearner(std::uint64_t seed = 0) : seed_(seed) {}

  /// Adds the views of one frame; the frame's number is part of the random keys. Views with an RMS below ½
  /// grey level are passed over.
  void add(std::uint32_t frame, std::span<const PatchView> views);

  /// Learns the entries of each degree and type. Level and contrast are taken off each view. k-means
  /// (k-means++, the best of 3 starts) runs for every k up to kMostEntries, and principal components are
  /// computed in each cluster. k and the numbers of components are those with the shortest description of N
  /// views of T independent numbers each (the pixels that they span on the mean),
  ///   Σ over clusters Nᵢ·(½ Σ ln λₖ + ½ (T − K)·ln σ² − ln share) + ½ ln(Nᵢ)·(K + 1)·(T + 1)
  /// λₖ being the variance of component k, σ² that of each other number (at least 10⁻⁴, the precision of
  /// samples), K at most a quarter of Nᵢ: the likelihood of probabilistic PCA, and Rissanen's cost of its
  /// parameters. The same bits at any thread count. Throws core::Cancelled.
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

/// Holds a patch as the dictionary describes it.
struct PatchCode {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::uint32_t entry = kNone;  ///< kNone: no entry fits, or the patch has no view
  bool reversed = false;        ///< the entry is laid against the patch's direction
  /// Grey levels of each channel of level + amplitude·mean + Σ coefficientₖ·componentₖ.
  graph::Level level{}, amplitude{};
  std::array<graph::Level, kMostComponents> coefficients{};
  int numbers = 0;                   ///< number of coefficients in use; the others are 0
  double residual = 0;               ///< grey levels, RMS of luma over the view
  double cost = 0;                   ///< nats
  std::optional<double> parametric;  ///< residual of the patch's own parameters on the same view
  double parametric_cost = 0;        ///< nats, coding_cost with the same pixels
};

/// Encodes each patch, by index, with the entry and coefficients of least cost.
/// Minimised is squared residual / (2 noise²) + cost in luma. Entries of its degree and type compete, or all
/// where there is none. Level, amplitude and coefficients are those of least squares in each channel: in
/// fire, red is full where green still rises, and no channel is luma on another scale. An entry fits where
/// luma's amplitude is above 0.2 of the view's RMS.
///
/// The cost is comparable with coding_cost: ½ ln(1 + pixels) nats for each of 5 numbers (place, orientation,
/// size, level, amplitude) and each coefficient, −ln of the entry's share, and ln(K + 1) for their number;
/// pixels are those that the view spans. `levels`: as for view_patches(). `noise`: grey levels, > 0; throws
/// core::InputError otherwise.
std::vector<PatchCode> encode(const cv::Mat& levels, const graph::AttributeGraph& graph,
                              const Dictionary& dictionary, double noise);

/// Draws the pixels that draw_fitted covers, with the appearance that the codes describe. A patch that looks
/// like a profile shows it along the curve, interpolated to the next patch's. A window is laid over the bands
/// that meet in it, its middle counting most; the bands continue into it with the nearest profile. A patch
/// without a code is drawn from its attributes. `codes`: one for each patch; throws core::InputError for
/// another number of them, for an entry that is not there, or for what draw_fitted refuses.
Sketchable draw_learned(const graph::AttributeGraph& graph, std::span<const PatchCode> codes,
                        const Dictionary& dictionary, cv::Size size, int channels);

/// Returns mean + Σ coefficientₖ·componentₖ.
std::vector<float> compose_shape(const DictionaryEntry& entry, std::span<const float> coefficients);

/// Writes the format "emberfold.dictionary", version 1. Throws core::InputError where the dictionary is not
/// valid. Reading the archive gives the same dictionary, bit for bit.
core::ModelArchive to_archive(const Dictionary& dictionary);

/// Reads a dictionary from an archive. Throws core::IoError, naming key or array and the expected value, for
/// a text that is no JSON, another format, a newer version, an array that is missing or has another type or
/// shape, and for all that validate() refuses.
Dictionary read_dictionary(const core::ModelArchive& archive);

}  // namespace emberfold::sketch
