// SPDX-License-Identifier: Apache-2.0
// Helpers of clip tests: a temporary folder, frames with known values, and the message of an exception.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/rng.hpp"

namespace emberfold::test {

namespace fs = std::filesystem;

/// A new folder, removed at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "emberfold-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A frame of uniform noise below `limit`, the same for the same seed.
inline cv::Mat noise_frame(cv::Size size, int type, std::uint64_t seed, std::uint32_t limit = 256) {
  core::Rng rng(seed);
  cv::Mat frame(size, type);
  cv::Mat values = frame.reshape(1);
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) {
      if (values.depth() == CV_16U)
        values.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(rng.below(limit));
      else
        values.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(rng.below(limit));
    }
  return frame;
}

/// A clip of such frames, CV_8UC1, another seed for each.
inline core::Clip noise_clip(cv::Size size, int frames, std::uint64_t seed, std::uint32_t limit = 256) {
  core::Clip clip;
  clip.info.width = size.width, clip.info.height = size.height, clip.info.depth = CV_8U;
  for (int t = 0; t < frames; ++t)
    clip.frames.push_back(noise_frame(size, CV_8UC1, seed * 1000 + static_cast<std::uint64_t>(t), limit));
  return clip;
}

inline bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// All bytes of a file.
inline std::string bytes_of(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

}  // namespace emberfold::test
