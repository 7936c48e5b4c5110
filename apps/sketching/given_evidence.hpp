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

/// Reads the probabilities of curves that `--evidence` names: a clip with a frame for each of the sketched
/// clip's, or one image for all of them. White is 1.
class GivenEvidence {
 public:
  /// Opens the file with the part and scale of the clip that it belongs to. Throws core::IoError and
  /// core::InputError, the latter where its frames have another size than the clip's.
  GivenEvidence(const std::string& name, const io::ReadOptions& read, const core::ClipInfo& clip);

  /// Reads the frame of number t; called once for each, in order. Throws core::InputError where there are
  /// fewer.
  void read(int t);
  /// Returns the probabilities of frame t, CV_32F, 0…1, and forgets them. Thread-safe.
  cv::Mat1f take(int t);

 private:
  [[nodiscard]] cv::Mat1f next();

  std::string name_;
  std::unique_ptr<core::FrameSource> source_;
  cv::Mat1f only_;  // of an image
  std::mutex mutex_;
  std::map<int, cv::Mat1f> waiting_;
};

}  // namespace emberfold::apps
