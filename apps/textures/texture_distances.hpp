// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "dytex/distances/distances.hpp"

// Tables and pictures of `dytex distance`.
namespace emberfold::apps {

/// Returns the measure with this name; nothing for other names.
std::optional<dytex::Measure> measure_of(const std::string& text);
/// Returns "kl, martin, angles, windows".
std::string measure_names();

/// Shortens paths to the fewest last parts that distinguish them.
std::vector<std::string> short_names(const std::vector<std::string>& paths);

/// Returns the matrix of distances, CV_64F; NaN where there is none.
cv::Mat measure_matrix(std::span<const dytex::Distances> pairs, dytex::Measure measure);

/// Writes {"format": "emberfold.texture_distances", "version", "models", "measures": {name: rows}, "angles"
/// (of two models)}; null for infinite or missing values.
nlohmann::ordered_json distances_json(const std::vector<std::string>& models,
                                      std::span<const dytex::Distances> pairs);

/// Writes all distances of the first model from the second, and back where that differs.
std::string pair_table(const std::vector<std::string>& names, const dytex::Distances& pair);
/// Writes one measure of all models as a table, a row each.
std::string matrix_table(const std::vector<std::string>& names, const cv::Mat& values,
                         dytex::Measure measure);
/// Writes the table as CSV with a header; fields without a number are empty.
std::string matrix_csv(const std::vector<std::string>& names, const cv::Mat& values);
/// Draws the table as a heat matrix.
cv::Mat draw_distances(const std::vector<std::string>& names, const cv::Mat& values, dytex::Measure measure);

/// The KL divergence of one model's clips from another's, by length.
struct Growth {
  std::string from, to;
  double rate = 0;             ///< nats per frame, asymptotically
  std::vector<double> values;  ///< for 1, 2, … frames, nats
};
/// Writes the curves as JSON.
nlohmann::ordered_json growth_json(const std::vector<Growth>& curves);
/// Draws divergence against the number of frames, as in Fig. 3 of Soatto, Doretto, Wu 2001.
cv::Mat draw_growth(const std::vector<Growth>& curves);

}  // namespace emberfold::apps
