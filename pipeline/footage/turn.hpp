// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pipeline/footage/play_order.hpp"

namespace emberfold::pipeline {

/// Estimates the motion from a frame (CV_8U, 1 or 3 channels) to the next, px, CV_32FC2, at most 2^15 vectors
/// (dytex::optical_flow). 0 where both differ by no more than noise: motion there would be that of
/// neighbours.
cv::Mat footage_motion(const cv::Mat& frame, const cv::Mat& next);

/// Draws the frame at `share` (0…1) of the way between two, both moved towards it and mixed.
cv::Mat draw_between(const cv::Mat& a, const cv::Mat& b, double share);

/// Finds when each place turns from one run of frames to another: where and when both look most similar.
/// `moment`: any moment of the transition. Returns moments of the transition, CV_32F, at most 80 px a side.
cv::Mat1f turning_places(const std::vector<cv::Mat>& footage, const PlayedMoment& moment);

/// Finds the turning places of one moment after the other, once for each transition.
class TurningPlaces {
 public:
  /// Returns those of a moment; empty where it is of no transition.
  cv::Mat1f at(const std::vector<cv::Mat>& footage, const PlayedMoment& moment);

 private:
  Turn turn_;  // of places_
  cv::Mat1f places_;
};

/// Draws a moment of the transition from one run of frames to another.
/// Both are moved towards each other by the motion between them; each place turns from one to the other
/// within about three moments of its turning place.
cv::Mat draw_turn(const std::vector<cv::Mat>& footage, const PlayedMoment& moment, const cv::Mat1f& places);

/// Returns a moment's frame, or draws it where it is of a transition. The frame is the footage's own.
cv::Mat draw_moment(const std::vector<cv::Mat>& footage, const PlayedMoment& moment, const cv::Mat1f& places);

}  // namespace emberfold::pipeline
