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

/// Keeps the placed blocks of an interrupted run in a small JSON file next to the output
/// ("emberfold.quilt_part"). The file is written every few seconds and when the run is stopped.
class QuiltCheckpoint {
 public:
  /// Binds a file to a request, to the loaded clips, and to the surface with this fingerprint, if any.
  QuiltCheckpoint(std::filesystem::path file, const QuiltRequest& request,
                  std::span<const dytex::Trajectories* const> held, const std::string& surface);

  /// Reads the blocks of an earlier run; none where there is no file. Throws core::IoError where it is
  /// damaged, core::InputError where it belongs to other options or another clip.
  [[nodiscard]] std::vector<dytex::QuiltChoice> read() const;
  /// Writes if the last write was some seconds ago, or `now`. Throws core::IoError.
  void write(std::span<const dytex::QuiltChoice> placed, bool now = false);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string belongs_;
  std::chrono::steady_clock::time_point written_{};  // long ago: the first blocks are written at once
};

}  // namespace emberfold::apps
