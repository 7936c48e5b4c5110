// SPDX-License-Identifier: Apache-2.0
#include "core/io/mask_file.hpp"

#include <opencv2/imgproc.hpp>

#include "core/io/image_files.hpp"

namespace emberfold::io {

cv::Mat read_mask(const std::string& path) {
  cv::Mat mask = read_image(path).pixels;
  if (mask.channels() == 3) cv::cvtColor(mask, mask, cv::COLOR_BGR2GRAY);
  return mask;
}

}  // namespace emberfold::io
