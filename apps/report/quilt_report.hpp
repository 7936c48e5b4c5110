// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A moment of the source beside the same moment of the quilt, CV_8UC3.
struct QuiltPair {
  int frame = 0;
  cv::Mat source, quilt;
};

struct QuiltPictures {
  std::vector<QuiltPair> pairs;
  cv::Mat map, seams;  ///< CV_8UC3
};

/// One HTML page that needs nothing else, some megabytes at most. `summary` as in summary.json.
std::string make_quilt_report(const std::string& clip, const QuiltPictures& pictures,
                              const nlohmann::ordered_json& summary);

}  // namespace emberfold::apps
