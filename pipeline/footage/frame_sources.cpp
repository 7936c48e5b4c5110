// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/frame_sources.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace emberfold::pipeline {

namespace {

constexpr int kCells = 80;            // on the longer side
constexpr double kStillShare = 0.25;  // share of a cell's pixels: where fewer move, it is still

}  // namespace

cv::Size source_cells(cv::Size frame) {
  const double cell = std::max(1.0, double(std::max(frame.width, frame.height)) / kCells);
  return {std::max(1, static_cast<int>(std::lround(frame.width / cell))),
          std::max(1, static_cast<int>(std::lround(frame.height / cell)))};
}

FrameSources same_sources(cv::Size cells, int frame, SourceKind kind) {
  return {cv::Mat1i(cells, frame), cv::Mat1b(cells, static_cast<std::uint8_t>(kind))};
}

void mark_still(FrameSources& sources, const cv::Mat1b& moves) {
  cv::Mat1b share;
  cv::resize(moves, share, sources.kinds.size(), 0, 0, cv::INTER_AREA);
  for (int y = 0; y < share.rows; ++y)
    for (int x = 0; x < share.cols; ++x) {
      const auto kind = sources.kind(y, x);
      if (kind == SourceKind::carried || kind == SourceKind::hiding) continue;
      if (share(y, x) < kStillShare * 255) sources.kinds(y, x) = static_cast<std::uint8_t>(SourceKind::still);
    }
}

}  // namespace emberfold::pipeline
