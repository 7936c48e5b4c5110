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

/// Opens the clips of a quilt, flattened on request.
class QuiltClips {
 public:
  QuiltClips(const QuiltRequest& request, const io::ReadOptions& read, Session& session);

  [[nodiscard]] std::vector<core::FrameSource*> sources() const;
  [[nodiscard]] std::vector<cv::Size> sizes() const;
  [[nodiscard]] const core::ClipInfo& info() const { return shown_.front()->info(); }

  /// Loads the whole clips, into a file in `folder` where they exceed the request's memory. Throws
  /// core::Cancelled.
  void load(const std::filesystem::path& folder, Session& session);
  [[nodiscard]] std::vector<const dytex::Trajectories*> loaded() const;
  [[nodiscard]] bool is_loaded() const { return !loaded_.empty(); }
  [[nodiscard]] std::size_t mapped_bytes() const { return cache_ ? cache_->mapped_bytes() : 0; }

 private:
  const QuiltRequest& request_;
  std::vector<std::unique_ptr<core::FrameSource>> opened_, shown_;
  std::optional<io::MappedFrames> cache_;
  std::vector<dytex::Trajectories> loaded_;
};

/// Returns a frame of a loaded clip.
cv::Mat frame_of(const dytex::Trajectories& source, int frame);

/// Joins loaded clips with their masks; sets `guide` where the request has one, with the levels of the
/// source.
std::vector<dytex::QuiltSource> quilt_sources(const QuiltClips& clips, const QuiltRequest& request,
                                              cv::Mat& guide);

}  // namespace emberfold::apps
