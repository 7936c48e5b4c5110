// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/raw_page.hpp"

#include <algorithm>
#include <bit>
#include <fstream>

#include <opencv2/imgproc.hpp>

namespace emberfold::io {

namespace {

int depth_of(const TiffPage& page) {
  if (page.format == 3) return page.bits == 32 ? CV_32F : page.bits == 64 ? CV_64F : -1;
  if (page.format != 1) return -1;
  return page.bits == 8 ? CV_8U : page.bits == 16 ? CV_16U : -1;
}

}  // namespace

cv::Mat read_raw_page(const std::filesystem::path& path, const TiffPage& page) {
  const int depth = depth_of(page);
  if (depth < 0 || (page.samples != 1 && page.samples != 3)) return {};
  cv::Mat pixels(static_cast<int>(page.height), static_cast<int>(page.width),
                 CV_MAKETYPE(depth, static_cast<int>(page.samples)));
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(page.offset));
  const std::size_t bytes = pixels.total() * pixels.elemSize();
  if (!in.read(reinterpret_cast<char*>(pixels.data), static_cast<std::streamsize>(bytes))) return {};
  if (page.little_endian != (std::endian::native == std::endian::little))
    for (std::size_t at = 0, each = pixels.elemSize1(); at < bytes; at += each)
      std::reverse(pixels.data + at, pixels.data + at + each);
  if (depth == CV_64F) pixels.convertTo(pixels, CV_32F);
  if (page.samples == 3) cv::cvtColor(pixels, pixels, cv::COLOR_RGB2BGR);
  return pixels;
}

}  // namespace emberfold::io
