// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/side_by_side.hpp"
#include "core/clip.hpp"
#include "graph/attribute_graph.hpp"
#include "pipeline/footage/footage.hpp"

namespace emberfold::apps {

/// Returns whether the film of this name is a single picture of some of its frames.
bool is_film_picture(const std::filesystem::path& path);

/// Shows a drawn clip next to its source, as in Fig. 12 of Wang & Zhu 2004: the training clip, the drawn
/// sketch, the drawn frame. A name that ends with .png makes a picture of six moments, one row for each of
/// these; any other name a video.
class SynthesisFilm {
 public:
  /// `clip`: frames of the clip, repeated; two panels if it is empty. `info`: of the drawn clip of `frames`
  /// frames. Errors as for io::create_video.
  SynthesisFilm(std::filesystem::path path, pipeline::Footage clip, const core::ClipInfo& info, int frames);
  /// Adds the next drawn frame and its graph.
  void add(const cv::Mat& frame, const graph::AttributeGraph& graph);
  /// Completes the video, or writes the picture. Throws core::IoError.
  void finish();

 private:
  std::filesystem::path path_;
  pipeline::Footage clip_;
  core::ClipInfo info_;
  int frames_ = 0, next_ = 0;
  std::vector<std::string> labels_;
  std::optional<SideBySide> video_;
  std::vector<std::vector<cv::Mat>> moments_;  ///< for a picture
  std::vector<int> numbers_;
};

}  // namespace emberfold::apps
