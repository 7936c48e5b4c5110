// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/io/clip_reader.hpp"

namespace emberfold::apps {

/// Reads the probabilities of curves that `--evidence` names: a clip with one frame for each frame of the
/// sketched clip, or one image for all of them. White is 1.
class GivenEvidence {
 public:
  /// Opens the file with the region and scale of its clip. Throws core::IoError, and core::InputError where
  /// the sizes of its frames and the clip's differ.
  GivenEvidence(const std::string& name, const io::ReadOptions& read, const core::ClipInfo& clip);

  /// Reads the probabilities of frame t; to be called once for each frame, in order. Throws core::InputError
  /// where there are fewer.
  void read(int t);
  /// Returns the probabilities of frame t, CV_32F, 0…1, and drops them. Thread-safe.
  cv::Mat1f take(int t);

 private:
  [[nodiscard]] cv::Mat1f next();

  std::string name_;
  std::unique_ptr<core::FrameSource> source_;
  cv::Mat1f only_;  // if it is one image
  std::mutex mutex_;
  std::map<int, cv::Mat1f> waiting_;
};

}  // namespace emberfold::apps
