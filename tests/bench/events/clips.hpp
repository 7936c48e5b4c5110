// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::figures {

/// A clip as the measures of events take it.
struct EventClip {
  std::string name;
  std::vector<cv::Mat1f> frames;  ///< luma, white = 255
  graph::SketchSequence sketch;   ///< each frame alone, by the default options
};

struct EventScene {
  EventClip clip;
  std::vector<graph::Event> truth;
  double a1 = 0, a2 = 0;  ///< mean over the strokes of all frames that tell it; NaN where none does
};

/// Up to `most` frames of a video from frame `first` on, at most 640 px on the longer side, and their
/// sketches. Throws Missing.
EventClip read_event_clip(const std::filesystem::path& path, const std::string& name, int first, int most);

/// One of the scene_folders(). Throws Missing.
EventScene read_event_scene(const std::filesystem::path& folder, int most);

/// The clip from its last frame to its first; its events, told of the clip forwards.
EventClip backwards(const EventClip& clip);
std::vector<graph::Event> told_forwards(std::vector<graph::Event> events, int frames);

/// With normal noise of this SD on each pixel, rounded to whole levels again, sketched anew.
EventClip with_noise(const EventClip& clip, double deviation, std::uint64_t seed);

/// F1 of one list against the other: four classes, 2 frames, 20 px; NaN where both are empty.
double agreement(const std::vector<graph::Event>& a, const std::vector<graph::Event>& b);

}  // namespace emberfold::figures
