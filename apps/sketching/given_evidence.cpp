// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/given_evidence.hpp"

#include <utility>

#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/error.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::apps {

GivenEvidence::GivenEvidence(const std::string& name, const io::ReadOptions& read, const core::ClipInfo& clip)
    : name_(name) {
  io::ReadOptions whole = read.beside();
  whole.grey = true, whole.first = 0, whole.last.reset();
  source_ = open_clip(name, whole, core::Warn{});
  if (source_->info().frames == 1)
    only_ = next();
  else if (read.first > 0 || read.last) {
    whole.first = read.first, whole.last = read.last;
    source_ = open_clip(name, whole, core::Warn{});
  }
  const auto& info = source_->info();
  if (info.width != clip.width || info.height != clip.height)
    throw core::InputError("--evidence: " + name + " is " + core::size_text(info.width, info.height) +
                           ", the clip is " + core::size_text(clip.width, clip.height));
}

cv::Mat1f GivenEvidence::next() {
  const cv::Mat frame = source_->next();
  if (frame.empty()) return {};
  cv::Mat1f probability;
  core::luma(core::to_levels(frame, source_->info())).convertTo(probability, CV_32F, 1.0 / 255);
  cv::min(probability, cv::Scalar(1), probability);
  cv::max(probability, cv::Scalar(0), probability);
  return probability;
}

void GivenEvidence::read(int t) {
  cv::Mat1f frame = only_.empty() ? next() : only_;
  if (frame.empty())
    throw core::InputError("--evidence: " + name_ + " ends after " + std::to_string(t) +
                           " frames, the clip goes on");
  const std::scoped_lock lock(mutex_);
  waiting_[t] = std::move(frame);
}

cv::Mat1f GivenEvidence::take(int t) {
  const std::scoped_lock lock(mutex_);
  return waiting_.extract(t).mapped();
}

}  // namespace emberfold::apps
