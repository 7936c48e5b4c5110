// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/extract.hpp"
#include "tests/bench/figures/polyline.hpp"

namespace emberfold::figures {

/// Holds the inputs of the measures; an empty path stands for a missing one.
struct Inputs {
  std::filesystem::path clips, scenes;
  std::filesystem::path
      dump;  ///< an existing folder, where scenes and reconstruction leave what peers work on
};

/// Thrown where a measure has not got what it reads; tells what.
struct Missing {
  std::string what;
};

/// The share of a frame's pixels that the sketch and its anchors hold.
inline constexpr double kShare = 0.2;

/// The options of all measures, the only place.
inline sketch::ExtractOptions usual_options() {
  return {};
}

/// A frame of a clip, as it was decoded (CV_8UC3).
struct ClipFrame {
  std::string clip;
  int number = 0;
  cv::Mat pixels;
};
/// These frames (ascending) of the six clips flag, flame, river, fountain, boiling and smoke. Missing where
/// the folder lacks one of them.
std::vector<ClipFrame> clip_frames(const std::filesystem::path& folder, const std::vector<int>& numbers);

/// Grey, with `longer` px on the longer side, areas averaged.
cv::Mat1b grey_at(const cv::Mat& pixels, int longer = 352);

/// One 8-bit channel as levels.
cv::Mat1f levels_of(const cv::Mat1b& bytes);

struct SceneFrame {
  int number = 0;
  cv::Mat1b pixels;
  std::vector<Segment> strokes;  ///< the true centre lines
  std::vector<Point> junctions;
};
struct Scene {
  std::string name;
  std::vector<SceneFrame> frames;
};
/// The folders with a truth in it, by name. Throws Missing where there is none.
std::vector<std::filesystem::path> scene_folders(const std::filesystem::path& folder);
/// Every `step`th frame from `first` on of all scenes in the folder, by name; at most `most` of each. Missing
/// where there is none.
std::vector<Scene> read_scenes(const std::filesystem::path& folder, int first, int step, int most = 1 << 20);

}  // namespace emberfold::figures
