// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/quilting/request.hpp"
#include "core/clip.hpp"
#include "core/io/mapped_frames.hpp"
#include "dytex/quilting/quilt.hpp"

namespace emberfold::apps {

/// The clips that a quilt is made from, opened and, where that was asked for, flattened.
class QuiltClips {
 public:
  QuiltClips(const QuiltRequest& request, const io::ReadOptions& read, Session& session);

  [[nodiscard]] std::vector<core::FrameSource*> sources() const;
  [[nodiscard]] std::vector<cv::Size> sizes() const;
  [[nodiscard]] const core::ClipInfo& info() const { return shown_.front()->info(); }

  /// Reads them whole; beyond the request's memory they lie in a file in `folder`. Throws core::Cancelled.
  void hold(const std::filesystem::path& folder, Session& session);
  [[nodiscard]] std::vector<const dytex::Trajectories*> held() const;
  [[nodiscard]] bool is_held() const { return !held_.empty(); }
  [[nodiscard]] std::size_t mapped_bytes() const { return cache_ ? cache_->mapped_bytes() : 0; }

 private:
  const QuiltRequest& request_;
  std::vector<std::unique_ptr<core::FrameSource>> opened_, shown_;
  std::optional<io::MappedFrames> cache_;
  std::vector<dytex::Trajectories> held_;
};

/// A frame of what is held.
cv::Mat frame_of(const dytex::Trajectories& source, int frame);

/// Masks and guides beside held clips; `guide` is set where the request has one, in the levels of the source.
std::vector<dytex::QuiltSource> quilt_sources(const QuiltClips& clips, const QuiltRequest& request,
                                              cv::Mat& guide);

}  // namespace emberfold::apps
