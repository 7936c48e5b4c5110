// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "apps/cli/command.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "sketch/dictionary/dictionary.hpp"
#include "sketch/extract.hpp"

// The dictionary of `emberfold sketch`: learned from the clip or earlier.
namespace emberfold::apps {

/// The request for a dictionary.
struct DictionaryRequest {
  bool learn = false;
  std::string folder;  ///< of an existing dictionary; empty: none
  [[nodiscard]] bool any() const { return learn || !folder.empty(); }
};

/// A dictionary and the sketches that it was learned from.
struct SketchDictionary {
  sketch::Dictionary dictionary;
  std::vector<graph::AttributeGraph> graphs;  ///< of the clip, if it was learned from them; else empty

  /// Returns the sketch of frame t: from learning if available, otherwise sketched now.
  [[nodiscard]] graph::AttributeGraph graph(int t, const cv::Mat& levels,
                                            const sketch::ExtractOptions& options) const {
    return graphs.empty() ? sketch::extract(levels, options) : graphs.at(static_cast<std::size_t>(t));
  }
};

/// Reads the dictionary, or learns it from the whole clip; nothing where none is requested. Throws
/// core::IoError where the folder holds none, and core::Cancelled.
std::optional<SketchDictionary> prepare_dictionary(const DictionaryRequest& request,
                                                   core::FrameSource& source,
                                                   const sketch::ExtractOptions& options,
                                                   const Session& session);

/// Encodes a frame's patches. `levels`: CV_32F, white = 255. The noise is measured in the frame.
std::vector<sketch::PatchCode> encode_frame(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                            const SketchDictionary& dictionary);

/// Sums the figures of the dictionary's codes over a clip.
class CodeFigures {
 public:
  void add(std::span<const sketch::PatchCode> codes);
  /// Writes {"entries", "components", "by_type", "coded_share", "residual", "cost"} in grey levels and nats,
  /// of learned and parametric patches at the same places.
  [[nodiscard]] nlohmann::ordered_json json(const sketch::Dictionary& dictionary) const;

 private:
  std::size_t patches_ = 0, profiles_ = 0, windows_ = 0;
  double learned_squares_ = 0, parametric_squares_ = 0, window_squares_ = 0;
  double cost_ = 0, parametric_cost_ = 0;
};

/// Writes dictionary/ and dictionary.png into the output.
void write_dictionary(io::OutputFolder& output, const sketch::Dictionary& dictionary);

}  // namespace emberfold::apps
