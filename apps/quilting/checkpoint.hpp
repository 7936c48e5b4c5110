// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/quilting/request.hpp"
#include "dytex/quilting/quilt.hpp"

namespace emberfold::apps {

/// What an interrupted run leaves: the blocks that it had placed, in a small JSON file beside the output
/// ("emberfold.quilt_part"), written every few seconds and when the run is stopped.
class QuiltCheckpoint {
 public:
  /// `file`: where it lies; `request` and `held`: what it belongs to.
  QuiltCheckpoint(std::filesystem::path file, const QuiltRequest& request,
                  std::span<const dytex::Trajectories* const> held);

  /// The blocks of an earlier run; none where there is no file. core::IoError where it is damaged,
  /// core::InputError where it belongs to other options or another clip.
  [[nodiscard]] std::vector<dytex::QuiltChoice> read() const;
  /// Writes if the last writing is some seconds ago, or `now`. core::IoError.
  void keep(std::span<const dytex::QuiltChoice> placed, bool now = false);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string belongs_;
  std::chrono::steady_clock::time_point written_{};  // long ago: the first blocks are written at once
};

}  // namespace emberfold::apps
