// SPDX-License-Identifier: Apache-2.0
#include "core/clip/masked_source.hpp"

namespace emberfold::core {

cv::Mat mask_of(const FrameSource& source) {
  const auto* known = dynamic_cast<const ClipKnowledge*>(&source);
  return known == nullptr ? cv::Mat() : known->mask();
}

std::vector<CameraMotion> drift_of(const FrameSource& source) {
  const auto* known = dynamic_cast<const ClipKnowledge*>(&source);
  return known == nullptr ? std::vector<CameraMotion>() : known->drift();
}

cv::Mat HeldOutside::next() {
  cv::Mat frame = source_->next();
  const cv::Mat mask = mask_of(*source_);
  if (frame.empty() || mask.empty()) return frame;
  if (held_.empty())
    held_ = frame.clone();
  else
    frame.copyTo(held_, mask);
  return held_.clone();
}

void HeldOutside::rewind() {
  source_->rewind();
  held_.release();
}

}  // namespace emberfold::core
