// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/clip.hpp"

namespace emberfold::core {

/// Reads frames first … last − 1 of a source, which must outlive it and whose position it changes.
class ClipRange final : public core::FrameSource {
 public:
  ClipRange(core::FrameSource& source, std::int64_t first, std::int64_t last)
      : source_(source), first_(first), last_(last), info_(source.info()) {
    info_.frames = last - first;
    if (!info_.times.empty()) info_.times = {info_.times.begin() + first, info_.times.begin() + last};
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override {
    if (position_ < 0) rewind();
    if (position_ >= last_) return {};
    ++position_;
    return source_.next();
  }
  void rewind() override {
    source_.rewind();
    for (std::int64_t i = 0; i < first_; ++i) source_.next();
    position_ = first_;
  }

 private:
  core::FrameSource& source_;
  std::int64_t first_, last_, position_ = -1;
  core::ClipInfo info_;
};

}  // namespace emberfold::core
