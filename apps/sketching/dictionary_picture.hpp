// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "sketch/dictionary/dictionary.hpp"

namespace emberfold::apps {

/// A row for each degree and type, a cell for each entry, those seen most first: its share of the row, its
/// mean as a patch (the curve runs upwards) and as the curve across it; below it what each component does, 2
/// SD to either side, and on the curve in the same colour. CV_8UC3.
cv::Mat draw_dictionary(const sketch::Dictionary& dictionary);

}  // namespace emberfold::apps
