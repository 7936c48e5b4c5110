// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/figures/inputs.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace emberfold::figures {

namespace fs = std::filesystem;

namespace {

constexpr std::array<const char*, 6> kClips{"flag.avi",     "flame.mp4",   "river.mp4",
                                            "fountain.avi", "boiling.avi", "smoke.mp4"};

/// The wanted frames (ascending) of a video; those behind its end are left out.
std::vector<cv::Mat> read_video(const fs::path& path, const std::vector<int>& numbers) {
  if (!fs::exists(path)) throw Missing{path.string()};
  cv::VideoCapture video(path.string());
  if (!video.isOpened()) throw Missing{path.string()};
  std::vector<cv::Mat> frames;
  cv::Mat frame;
  for (int at = 0; frames.size() < numbers.size() && video.grab(); ++at) {
    if (at != numbers[frames.size()]) continue;
    video.retrieve(frame);
    frames.push_back(frame.clone());
  }
  return frames;
}

Point point_of(const nlohmann::json& pair) {
  return {pair.at(0).get<double>(), pair.at(1).get<double>()};
}

Scene read_scene(const fs::path& folder, int first, int step, int most) {
  std::ifstream file(folder / "truth.json");
  const nlohmann::json truth = nlohmann::json::parse(file);
  std::vector<int> numbers;
  const int count = truth.at("frames").get<int>();
  for (int f = first; f < count && static_cast<int>(numbers.size()) < most; f += step) numbers.push_back(f);
  const std::vector<cv::Mat> pixels = read_video(folder / "clip.avi", numbers);
  if (pixels.size() != numbers.size())
    throw Missing{(folder / "clip.avi").string() + " as long as its truth"};
  Scene scene{folder.filename().string(), {}};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    SceneFrame frame;
    frame.number = numbers[i];
    cv::cvtColor(pixels[i], frame.pixels, cv::COLOR_BGR2GRAY);
    const auto at = static_cast<std::size_t>(numbers[i]);
    for (const auto& stroke : truth.at("strokes").at(at)) {
      std::vector<Point> curve;
      for (const auto& pair : stroke.at("points")) curve.push_back(point_of(pair));
      const std::vector<Segment> parts = pieces(curve, stroke.at("sigma").get<double>());
      frame.strokes.insert(frame.strokes.end(), parts.begin(), parts.end());
    }
    for (const auto& pair : truth.at("junctions").at(at)) frame.junctions.push_back(point_of(pair));
    scene.frames.push_back(std::move(frame));
  }
  return scene;
}

}  // namespace

std::vector<ClipFrame> clip_frames(const fs::path& folder, const std::vector<int>& numbers) {
  if (folder.empty()) throw Missing{"a folder of clips (--clips, EMBERFOLD_CLIPS)"};
  std::vector<ClipFrame> result;
  for (const char* name : kClips) {
    const std::vector<cv::Mat> pixels = read_video(folder / name, numbers);
    if (pixels.size() != numbers.size())
      throw Missing{(folder / name).string() + " with frame " + std::to_string(numbers[pixels.size()])};
    for (std::size_t i = 0; i < pixels.size(); ++i)
      result.push_back({fs::path(name).stem().string(), numbers[i], pixels[i]});
  }
  return result;
}

cv::Mat1b grey_at(const cv::Mat& pixels, int longer) {
  cv::Mat grey, scaled;
  cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  const double scale = longer / static_cast<double>(std::max(grey.cols, grey.rows));
  if (scale == 1) return grey;
  cv::resize(grey, scaled, {cvRound(grey.cols * scale), cvRound(grey.rows * scale)}, 0, 0, cv::INTER_AREA);
  return scaled;
}

cv::Mat1f levels_of(const cv::Mat1b& bytes) {
  cv::Mat1f levels;
  bytes.convertTo(levels, CV_32F);
  return levels;
}

std::vector<fs::path> scene_folders(const fs::path& folder) {
  if (folder.empty()) throw Missing{"a folder of scenes (--scenes, EMBERFOLD_SCENES)"};
  std::vector<fs::path> folders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (fs::exists(entry.path() / "truth.json")) folders.push_back(entry.path());
  if (folders.empty())
    throw Missing{folder.string() + " with scenes (clip.avi and truth.json in a folder each)"};
  std::ranges::sort(folders);
  return folders;
}

std::vector<Scene> read_scenes(const fs::path& folder, int first, int step, int most) {
  std::vector<Scene> scenes;
  for (const fs::path& path : scene_folders(folder)) scenes.push_back(read_scene(path, first, step, most));
  return scenes;
}

}  // namespace emberfold::figures
