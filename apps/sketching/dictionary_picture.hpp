// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "sketch/dictionary/dictionary.hpp"

namespace emberfold::apps {

/// Draws a dictionary, CV_8UC3: a row for each degree and type, a cell for each entry, the most frequent
/// first. A cell shows the entry's share of the row, its mean as a patch (the curve runs upwards) and as a
/// profile. Below are the mean ± 2 SD of each component, which the profile shows in the same colour.
cv::Mat draw_dictionary(const sketch::Dictionary& dictionary);

}  // namespace emberfold::apps
