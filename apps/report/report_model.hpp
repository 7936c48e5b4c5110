// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"
#include "mcmc/model/motion_model.hpp"

// Writes models and the clips drawn from them as JSON of bounded size, for the report.
namespace emberfold::apps {

/// Clips that play synchronously, side by side in one video.
struct ReportClips {
  std::vector<std::string> names;  ///< from left to right
  std::vector<unsigned char> mp4;  ///< H.264, at most kClipBytes
  int width = 0, height = 0;       ///< px, of one clip
  int frames = 0;
  double fps = 25;
};

/// A table with a row for each measure and a column for each clip.
struct ReportMeasures {
  struct Row {
    std::string name, about;
    std::vector<std::optional<double>> values;  ///< by column
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
  std::string note;
};

/// Writes the video and the table for the page.
nlohmann::ordered_json report_clips(const ReportClips& clips);
nlohmann::ordered_json report_measures(const ReportMeasures& measures);

/// Writes Θ for the page: coefficients, poles, rates next to the counts of `events`, maps of at most 4000
/// cells, at most 24 exemplars.
nlohmann::ordered_json report_motion_model(const mcmc::MotionModel& model,
                                           std::span<const graph::Event> events);

/// Writes the same figures for summary.json: {"sway": …, "contrast": …, "rates": …}.
nlohmann::ordered_json motion_model_figures(const mcmc::MotionModel& model);

/// Lists [real, imaginary part] of at most 500 eigenvalues.
nlohmann::ordered_json report_eigenvalues(std::span<const std::complex<double>> eigenvalues);

}  // namespace emberfold::apps
