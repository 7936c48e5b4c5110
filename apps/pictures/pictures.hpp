// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/cli/command.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/report/report.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/gain_totals.hpp"
#include "pipeline/reconstruct.hpp"

namespace emberfold::apps {

/// The results of the second pass over a clip.
struct Pictures {
  ReportInput report;               ///< only its pictures are set
  std::vector<double> share, psnr;  ///< of the reconstructed frames
  pipeline::GainTotals gains;       ///< of the patches of these frames
  int not_converged = 0;
  cv::Mat mean;  ///< of all frames, CV_8UC3
};

/// Writes overlay.mp4, matches/ and, if it `reconstructs` every frame, reconstruction.avi, and makes the
/// report's pictures. `events` are ordered by frame.
Pictures draw_pictures(core::FrameSource& source, const graph::MotionGraph& motion,
                       std::span<const graph::Event> events, bool reconstructs, io::OutputFolder& output,
                       const Session& session);

}  // namespace emberfold::apps
