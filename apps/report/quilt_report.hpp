// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A frame of the source and the corresponding frame of the quilt, CV_8UC3.
struct QuiltPair {
  int frame = 0;
  cv::Mat source, quilt;
};

/// The pictures of a quilt's report.
struct QuiltPictures {
  std::vector<QuiltPair> pairs;
  cv::Mat map, seams;  ///< CV_8UC3
};

/// Returns one self-contained HTML page of a few megabytes at most. `summary`: the content of summary.json.
std::string make_quilt_report(const std::string& clip, const QuiltPictures& pictures,
                              const nlohmann::ordered_json& summary);

}  // namespace emberfold::apps
