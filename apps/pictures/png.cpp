// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/png.hpp"

#include <ostream>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"

namespace emberfold::apps {

namespace {

void put_png(std::ostream& out, const cv::Mat& picture) {
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", picture, png)) throw core::IoError("a picture cannot be encoded as PNG");
  out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
}

}  // namespace

void write_png(io::OutputFolder& output, const std::string& name, const cv::Mat& picture) {
  output.write(name, [&](std::ostream& out) { put_png(out, picture); });
}

void write_png(io::StagedFile& file, const cv::Mat& picture) {
  file.write([&](std::ostream& out) { put_png(out, picture); });
  file.finish();
}

}  // namespace emberfold::apps
