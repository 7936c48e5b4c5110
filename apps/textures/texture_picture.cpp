// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/textures/texture_modes.hpp"
#include "core/clip.hpp"

namespace emberfold::apps {

namespace {

constexpr int kColumns = 4, kTiles = 12, kTileWidth = 240, kMargin = 12, kCaption = 24;
constexpr int kCourses = 4, kCourseHeight = 84;
const cv::Scalar kFaint(215, 212, 208);

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), share < 0.01 ? "%.2f %%" : "%.1f %%", 100 * share);
  return text.data();
}

// Returns a column of pixels as a frame, CV_32F.
cv::Mat as_frame(const Eigen::Ref<const Eigen::VectorXf>& column, const core::ClipInfo& info) {
  cv::Mat frame(info.height, info.width, CV_32FC(info.channels));
  std::copy(column.data(), column.data() + column.size(), frame.ptr<float>());
  return frame;
}

// Colours signed luma: white at 0, blue below, red above; full colour near the largest value, without
// outliers.
cv::Mat signed_picture(const cv::Mat& luma) {
  std::vector<float> sizes(luma.begin<float>(), luma.end<float>());
  for (float& v : sizes) v = std::abs(v);
  const auto place = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 995 / 1000);
  std::nth_element(sizes.begin(), place, sizes.end());
  const float full = std::max(*place, 1e-20F);
  const cv::Vec3f white(250, 250, 250), blue(170, 90, 20), red(25, 45, 190);
  cv::Mat picture(luma.size(), CV_8UC3);
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      const float v = std::clamp(luma.at<float>(y, x) / full, -1.0F, 1.0F);
      const cv::Vec3f colour = white + (v < 0 ? blue - white : red - white) * std::abs(v);
      for (int c = 0; c < 3; ++c)
        picture.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(colour[c]);
    }
  return picture;
}

cv::Mat mean_picture(const dytex::LinearDynamicTexture& texture) {
  cv::Mat bytes = core::to_bytes(as_frame(texture.mean, texture.info));
  if (bytes.channels() == 1) cv::cvtColor(bytes, bytes, cv::COLOR_GRAY2BGR);
  return bytes;
}

cv::Size tile_size(const core::ClipInfo& info) {
  const double height = static_cast<double>(kTileWidth) * info.height / info.width;
  return {kTileWidth, static_cast<int>(std::clamp(std::round(height), 24.0, 600.0))};
}

void draw_tile(cv::Mat& picture, int index, const cv::Mat& content, const std::string& caption) {
  const cv::Size size = content.size();
  const cv::Point corner(kMargin + (index % kColumns) * (size.width + kMargin),
                         kMargin + (index / kColumns) * (size.height + kCaption + kMargin));
  const cv::Rect box(corner, size);
  content.copyTo(picture(box));
  cv::rectangle(picture, box, kFaint);
  write_text(picture, caption, {corner.x + 2, corner.y + size.height + 16});
}

// Draws a state over the training frames with its zero line.
void draw_course(cv::Mat& picture, int top, int index, const Eigen::Ref<const Eigen::RowVectorXd>& state) {
  const int left = kMargin, right = picture.cols - kMargin, middle = top + 18 + (kCourseHeight - 18) / 2;
  const double reach = (kCourseHeight - 26) / 2.0;
  const double most = std::max(state.cwiseAbs().maxCoeff(), 1e-20);
  const auto colour = stroke_colour(static_cast<std::uint32_t>(index + 1));
  cv::line(picture, {left, middle}, {right, middle}, kFaint);
  std::vector<cv::Point> course;
  constexpr int kShift = 4;
  for (Eigen::Index t = 0; t < state.size(); ++t) {
    const double x = left + (state.size() > 1 ? double(t) / double(state.size() - 1) : 0) * (right - left);
    course.emplace_back(cvRound(x * (1 << kShift)),
                        cvRound((middle - state(t) / most * reach) * (1 << kShift)));
  }
  cv::polylines(picture, course, false, cv::Scalar(colour.blue, colour.green, colour.red) * 0.75, 1,
                cv::LINE_AA, kShift);
  std::array<char, 96> label{};
  std::snprintf(label.data(), label.size(), "state %d, frames 0 to %lld, largest %.4g", index + 1,
                static_cast<long long>(state.size() - 1), most);
  write_text(picture, label.data(), {left + 2, top + 12});
}

}  // namespace

cv::Mat draw_components(const dytex::LinearDynamicTexture& texture) {
  const cv::Size size = tile_size(texture.info);
  const int components = static_cast<int>(std::min<Eigen::Index>(kTiles - 1, texture.components()));
  const int rows = (components + kColumns) / kColumns;
  const int courses = std::min(kCourses, components);
  const int grid = kMargin + rows * (size.height + kCaption + kMargin);
  cv::Mat picture(grid + courses * kCourseHeight + kMargin, kMargin + kColumns * (size.width + kMargin),
                  CV_8UC3, kPaper);
  const auto fitted = [&](const cv::Mat& tile) {
    cv::Mat resized;
    cv::resize(tile, resized, size, 0, 0, tile.cols > size.width ? cv::INTER_AREA : cv::INTER_NEAREST);
    return resized;
  };
  draw_tile(picture, 0, fitted(mean_picture(texture)), "mean");
  const double all = std::max(texture.singular.squaredNorm(), 1e-300);
  for (int i = 0; i < components; ++i) {
    const double share = i < texture.singular.size() ? texture.singular(i) * texture.singular(i) / all : 0;
    draw_tile(picture, i + 1, fitted(signed_picture(core::luma(as_frame(texture.C.col(i), texture.info)))),
              std::to_string(i + 1) + ": " + percent(share) + " of the variance");
  }
  for (int i = 0; i < courses; ++i) draw_course(picture, grid + i * kCourseHeight, i, texture.states.row(i));
  return picture;
}

}  // namespace emberfold::apps
