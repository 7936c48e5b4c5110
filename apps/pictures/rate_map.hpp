// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/draw.hpp"
#include "graph/events/events.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::apps {

/// What a map of rates is drawn of.
struct RateMap {
  const mcmc::CellMap* map = nullptr;  ///< values ≥ 0
  double factor = 1;                   ///< what is shown is factor · value
  bool relative = false;               ///< shown on both sides of 1, as ratios; else from 0
  std::string unit;                    ///< of what is shown, in ASCII: "births per frame and 100x100 px"
  graph::EventType type = graph::EventType::birth;  ///< of the events that are put on it as dots
};

/// Births in a frame and 100 × 100 px; and how often strokes die, times what is usual for their size.
RateMap birth_map(const mcmc::MotionModel& model);
RateMap death_map(const mcmc::MotionModel& model);

/// Of a share: of the largest value, 0…1, warm; below 0, as ratios below 1 have it, cold.
Colour rate_colour(double share);

/// The values between the cells' middles by bicubic interpolation, kept within those of the map, at each
/// pixel of a frame of width · scale × height · scale px (CV_32F, factor not applied).
cv::Mat1f smooth_map(const mcmc::CellMap& map, cv::Size frame, double scale);

/// The map over the frame `under` (CV_8UC3, as large as the clip's frames), grey and dimmed and enlarged as
/// the overlay is; a dot for every event of its type of probability 0.5 or more; a legend with the colours'
/// scale below: from 0 to the largest value, or as far below 1 as above it, half as much again at least.
cv::Mat draw_rate_map(const cv::Mat& under, const RateMap& what, std::span<const graph::Event> events);

}  // namespace emberfold::apps
