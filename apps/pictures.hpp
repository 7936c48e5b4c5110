// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/command.hpp"
#include "apps/draw.hpp"
#include "apps/image_evidence.hpp"
#include "apps/output_folder.hpp"
#include "apps/reconstruct.hpp"
#include "apps/report.hpp"
#include "core/clip.hpp"
#include "graph/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

struct PictureOptions {
  sketch::FillOptions fill;
  bool reconstruction = false;  ///< reconstruct every frame and write reconstruction.avi
};

/// What the second run through a clip finds and draws.
struct Pictures {
  ReportInput report;               ///< its pictures alone are set
  std::vector<double> share, psnr;  ///< of the frames that were reconstructed
  GainTotals gains;                 ///< of these frames' patches
  int not_converged = 0;
  cv::Mat mean;  ///< of all frames, CV_8UC3
};

/// A picture as PNG into the folder.
void write_png(OutputFolder& output, const std::string& name, const cv::Mat& picture);

/// Writes overlay.mp4, matches/ and, where asked for, reconstruction.avi, and makes the report's pictures.
/// `events` are ordered by frame.
Pictures draw_pictures(core::FrameSource& source, const graph::MotionGraph& motion,
                       std::span<const graph::Event> events, const PictureOptions& options,
                       OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
