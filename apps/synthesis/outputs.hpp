// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/pictures/synthesis_film.hpp"
#include "apps/synthesis/request.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/files.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/output/opacity.hpp"

namespace emberfold::apps {

/// The requested files of a new clip: the clip, its graphs, overlay and film. Each gets its
/// final name only in finish().
class SynthOutputs {
 public:
  /// Keeps a reference to the request. Throws Misuse, core::IoError where a file cannot be written.
  SynthOutputs(const SynthRequest& asked, const pipeline::ClipSynthesis& frames);

  /// Writes the next frame; to be called while ClipSynthesis::each() hands it over.
  void write(const cv::Mat& frame);
  /// Completes all files; their length is the number of frames written.
  void finish();

  [[nodiscard]] int frames() const { return frames_; }
  /// Returns the format of the written clip.
  [[nodiscard]] const core::ClipInfo& info() const { return written_; }

 private:
  [[nodiscard]] cv::Mat written_frame(const cv::Mat& frame) const;

  const SynthRequest& asked_;
  core::ClipInfo info_, written_;  // of the drawn frames, and of the written ones
  std::unique_ptr<io::VideoWriter> clip_, overlay_;
  std::optional<pipeline::Ground> ground_;  // of the written size
  pipeline::Light light_ = pipeline::Light::display;
  std::optional<SynthesisFilm> film_;
  std::optional<io::StagedFile> motion_file_;
  std::optional<graph::MotionGraph> motion_;
  std::vector<graph::Event> events_;
  int frames_ = 0;
};

}  // namespace emberfold::apps
