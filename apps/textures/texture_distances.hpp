// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "dytex/distances/distances.hpp"

// What `dytex distance` tells of models that are named.
namespace emberfold::apps {

/// The measure of this name; nothing where it is none.
std::optional<dytex::Measure> measure_of(const std::string& text);
/// "kl, martin, binet-cauchy, angles"
std::string measure_names();

/// Short names for paths: the last parts, or as much more as tells them apart.
std::vector<std::string> short_names(const std::vector<std::string>& paths);

/// The matrix as an image, CV_64F; NaN where there is no such distance.
cv::Mat measure_matrix(std::span<const dytex::Distances> pairs, dytex::Measure measure);

/// {"format": "emberfold.texture_distances", "version", "models", "measures": {name: rows}, "angles" (of two
/// models)}; null for what is infinite or not there.
nlohmann::ordered_json distances_json(const std::vector<std::string>& models,
                                      std::span<const dytex::Distances> pairs);

/// All distances of the first from the second, and back where that differs.
std::string pair_table(const std::vector<std::string>& names, const dytex::Distances& pair);
/// One measure of all models, a row each.
std::string matrix_table(const std::vector<std::string>& names, const cv::Mat& values,
                         dytex::Measure measure);
/// The same as CSV, a head line first; empty fields where there is no number.
std::string matrix_csv(const std::vector<std::string>& names, const cv::Mat& values);
cv::Mat draw_distances(const std::vector<std::string>& names, const cv::Mat& values, dytex::Measure measure);

/// KL of one model's clips from another's as they grow longer.
struct Growth {
  std::string from, to;
  double rate = 0;             ///< nats a frame, in the long run
  std::vector<double> values;  ///< of 1, 2, … frames, nats
};
nlohmann::ordered_json growth_json(const std::vector<Growth>& curves);
/// As Fig. 3 of Soatto, Doretto, Wu 2001: divergence against the number of frames.
cv::Mat draw_growth(const std::vector<Growth>& curves);

}  // namespace emberfold::apps
