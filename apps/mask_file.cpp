// SPDX-License-Identifier: Apache-2.0
#include "apps/mask_file.hpp"

#include <opencv2/imgproc.hpp>

#include "apps/image_files.hpp"

namespace emberfold::apps {

cv::Mat read_mask(const std::string& path) {
  cv::Mat mask = read_image(path).pixels;
  if (mask.channels() == 3) cv::cvtColor(mask, mask, cv::COLOR_BGR2GRAY);
  return mask;
}

}  // namespace emberfold::apps
