// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "core/context.hpp"
#include "dytex/measures.hpp"

namespace emberfold::apps {

/// The spectra of a clip in time and in space, gathered frame by frame. Of frames above 2^18 pixels the
/// temporal one is taken at every second, third … pixel each way, which bounds the memory and not the truth.
class ClipSpectra {
 public:
  ClipSpectra(cv::Size size, int segment, int rings);

  /// The next frames' luma, CV_32F. Throws Interrupted.
  void add(std::span<const cv::Mat> luma, const core::Context& context);
  [[nodiscard]] Eigen::VectorXd temporal() const { return time_.power(); }
  [[nodiscard]] Eigen::VectorXd radial() const { return space_ / frames_; }

 private:
  int stride_;
  dytex::TemporalSpectrum time_;
  int rings_, frames_ = 0;
  Eigen::VectorXd space_;
};

/// How long a segment is that fits into `frames` frames: 32, 16, 8 or 4; 0 where none does.
int segment_length(std::int64_t frames);

/// {"temporal_db", "radial_db"}: log-spectral distances of one clip to another.
nlohmann::ordered_json distances_json(const ClipSpectra& a, const ClipSpectra& b);

/// 10 log₁₀ of power above the floor, rounded: a curve to draw.
nlohmann::ordered_json decibels_json(const Eigen::VectorXd& power);

}  // namespace emberfold::apps
