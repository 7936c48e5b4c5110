// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/draw.hpp"
#include "graph/events/events.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::apps {

/// A map of rates and its display options.
struct RateMap {
  const mcmc::CellMap* map = nullptr;  ///< values ≥ 0
  double factor = 1;                   ///< the displayed value is factor · value
  bool relative = false;               ///< shown on both sides of 1, as ratios; else from 0
  std::string unit;                    ///< of displayed values, in ASCII: "births per frame and 100x100 px"
  graph::EventType type = graph::EventType::birth;  ///< of the events drawn on it as dots
};

/// Describes a model's map of births per frame and 100 × 100 px, and of death rates relative to the usual.
RateMap birth_map(const mcmc::MotionModel& model);
RateMap death_map(const mcmc::MotionModel& model);

/// Returns the colour of a share of the largest value: warm in 0…1, cold below 0 (ratios below 1).
Colour rate_colour(double share);

/// Interpolates cell values bicubically at each pixel of a frame of width · scale × height · scale px.
/// Returns CV_32F clamped to the range of the map's values; the factor is not applied.
cv::Mat1f smooth_map(const mcmc::CellMap& map, cv::Size frame, double scale);

/// Draws the map over the frame `under` (CV_8UC3, of the clip's size), which is grey, dimmed and enlarged
/// like the overlay. Events of its type with probability 0.5 or more are dots. A legend shows the colour
/// scale: from 0 to the largest value, or for ratios equally far below and above 1, at least to 1.5.
cv::Mat draw_rate_map(const cv::Mat& under, const RateMap& what, std::span<const graph::Event> events);

}  // namespace emberfold::apps
