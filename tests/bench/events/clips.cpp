// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/clips.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "graph/events/event_score.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/matching/time_reversal.hpp"
#include "sketch/extract.hpp"
#include "tests/bench/figures/inputs.hpp"

namespace emberfold::figures {

namespace fs = std::filesystem;

namespace {

constexpr int kLonger = 640;

void sketch_frames(EventClip& clip, double fps) {
  std::vector<graph::AttributeGraph> graphs(clip.frames.size());
  core::parallel_for(graphs.size(), {},
                     [&](std::size_t i) { graphs[i] = sketch::extract(clip.frames[i], usual_options()); });
  clip.sketch = {};
  clip.sketch.width = clip.frames.front().cols, clip.sketch.height = clip.frames.front().rows;
  clip.sketch.fps = fps;
  for (const auto& graph : graphs) clip.sketch.append(graph);
}

}  // namespace

EventClip read_event_clip(const fs::path& path, const std::string& name, int first, int most) {
  cv::VideoCapture video;
  if (!fs::exists(path) || !video.open(path.string())) throw Missing{path.string()};
  EventClip clip{name, {}, {}};
  cv::Mat pixels;
  for (int at = 0; static_cast<int>(clip.frames.size()) < most && video.grab(); ++at) {
    if (at < first) continue;
    video.retrieve(pixels);
    clip.frames.push_back(levels_of(grey_at(pixels, std::min(kLonger, std::max(pixels.cols, pixels.rows)))));
  }
  if (clip.frames.size() < 2) throw Missing{path.string() + " with two frames from " + std::to_string(first)};
  const double fps = video.get(cv::CAP_PROP_FPS);
  sketch_frames(clip, fps > 0 && fps <= 1000 ? fps : 25);
  return clip;
}

EventScene read_event_scene(const fs::path& folder, int most) {
  EventScene scene{read_event_clip(folder / "clip.avi", folder.filename().string(), 0, most), {}, 0, 0};
  std::ifstream events(folder / "truth.json");
  scene.truth = graph::read_events(events, (folder / "truth.json").string());
  std::erase_if(scene.truth,
                [&](const graph::Event& e) { return e.frame >= static_cast<int>(scene.clip.frames.size()); });
  std::ifstream file(folder / "truth.json");
  double strokes = 0;
  const nlohmann::json truth = nlohmann::json::parse(file);
  for (const auto& frame : truth.at("strokes"))
    for (const auto& stroke : frame) {
      if (!stroke.contains("ar")) continue;
      scene.a1 += stroke.at("ar").at(0).get<double>();
      scene.a2 += stroke.at("ar").at(1).get<double>();
      ++strokes;
    }
  scene.a1 /= strokes;
  scene.a2 /= strokes;
  return scene;
}

EventClip backwards(const EventClip& clip) {
  EventClip turned{clip.name, {clip.frames.rbegin(), clip.frames.rend()}, {}};
  turned.sketch.width = clip.sketch.width, turned.sketch.height = clip.sketch.height;
  turned.sketch.fps = clip.sketch.fps;
  for (auto graph = clip.sketch.frames.rbegin(); graph != clip.sketch.frames.rend(); ++graph)
    turned.sketch.append(*graph);
  return turned;
}

std::vector<graph::Event> told_forwards(std::vector<graph::Event> events, int frames) {
  for (auto& event : events) {
    event.frame = frames - event.frame;  // the gap before frame t is the one before frame T − t
    event.type = graph::reverse_time(event.type);
    std::swap(event.before, event.after);
  }
  graph::sort_events(events);
  return events;
}

EventClip with_noise(const EventClip& clip, double deviation, std::uint64_t seed) {
  EventClip noisy{clip.name, std::vector<cv::Mat1f>(clip.frames.size()), {}};
  core::parallel_for(clip.frames.size(), {}, [&](std::size_t t) {
    core::Rng rng(seed, {static_cast<std::uint32_t>(t)});
    noisy.frames[t] = clip.frames[t].clone();
    for (float& level : noisy.frames[t])
      level = std::clamp(std::round(level + static_cast<float>(deviation * rng.normal())), 0.0F, 255.0F);
  });
  sketch_frames(noisy, clip.sketch.fps);
  return noisy;
}

double agreement(const std::vector<graph::Event>& a, const std::vector<graph::Event>& b) {
  if (a.empty() && b.empty()) return std::nan("");
  return graph::score_events(a, b).four.back().f1();
}

}  // namespace emberfold::figures
