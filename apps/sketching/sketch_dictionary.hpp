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

// The dictionary of `emberfold sketch`: learned from the clip, or one learned before.
namespace emberfold::apps {

struct DictionaryRequest {
  bool learn = false;
  std::string folder;  ///< one learned before; empty: none
  [[nodiscard]] bool any() const { return learn || !folder.empty(); }
};

struct SketchDictionary {
  sketch::Dictionary dictionary;
  std::vector<graph::AttributeGraph> graphs;  ///< the clip's, where it was learned from them; else none

  /// The sketch of frame t, found while learning, or now.
  [[nodiscard]] graph::AttributeGraph graph(int t, const cv::Mat& levels,
                                            const sketch::ExtractOptions& options) const {
    return graphs.empty() ? sketch::extract(levels, options) : graphs.at(static_cast<std::size_t>(t));
  }
};

/// Reads the dictionary, or learns it from the whole clip. Nothing where none is asked for. core::IoError
/// where the folder holds none; core::Cancelled.
std::optional<SketchDictionary> prepare_dictionary(const DictionaryRequest& request,
                                                   core::FrameSource& source,
                                                   const sketch::ExtractOptions& options,
                                                   const Session& session);

/// `levels`: CV_32F, white = 255. The noise is the frame's own.
std::vector<sketch::PatchCode> encode_frame(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                            const SketchDictionary& dictionary);

/// What the dictionary's codes come to, over a clip.
class CodeFigures {
 public:
  void add(std::span<const sketch::PatchCode> codes);
  /// {"entries", "components", "by_type", "coded_share", "residual", "cost"}: grey levels and nats, learned
  /// beside parametric on the same patches.
  [[nodiscard]] nlohmann::ordered_json json(const sketch::Dictionary& dictionary) const;

 private:
  std::size_t patches_ = 0, profiles_ = 0, windows_ = 0;
  double learned_squares_ = 0, parametric_squares_ = 0, window_squares_ = 0;
  double cost_ = 0, parametric_cost_ = 0;
};

/// Writes dictionary/ and dictionary.png into the output.
void write_dictionary(io::OutputFolder& output, const sketch::Dictionary& dictionary);

}  // namespace emberfold::apps
