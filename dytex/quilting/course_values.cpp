// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/course_values.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/math/simd_clones.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kValuesSummed = 512;
constexpr float kMostValue = 512 * kValuesPerLevel;

template <class T>
void convert(const std::byte* chunk, std::size_t skip, std::size_t n, float scale, CourseValue* out) {
  const T* in = reinterpret_cast<const T*>(chunk) + skip;
  for (std::size_t i = 0; i < n; ++i)
    out[i] = static_cast<CourseValue>(
        std::lrint(std::clamp(static_cast<float>(in[i]) * scale, -kMostValue, kMostValue)));
}

void convert_bytes(const std::byte* chunk, std::size_t skip, std::size_t n, CourseValue* out) {
  const auto* in = reinterpret_cast<const std::uint8_t*>(chunk) + skip;
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<CourseValue>(in[i] * kValuesPerLevel);
}

// n ≤ kValuesSummed, so that the sum fits.
EMBERFOLD_SIMD_CLONES
std::int32_t squared_step_of_few(const CourseValue* a, const CourseValue* b, std::size_t n) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const int d = a[i] - b[i];
    sum += (d * d) >> 7;
  }
  return sum;
}

}  // namespace

bool CourseValues::may_show(const SourcePixel& at) const {
  const QuiltSource& source = sources_[static_cast<std::size_t>(at.source)];
  const cv::Size size = source.trajectories->size();
  if (at.x < 0 || at.y < 0 || at.x >= size.width || at.y >= size.height) return false;
  return source.forbidden.empty() || source.forbidden.at<unsigned char>(at.y, at.x) == 0;
}

void CourseValues::copy(const SourcePixel& at, int begin, int end, CourseValue* out) const {
  const Trajectories& source = *sources_[static_cast<std::size_t>(at.source)].trajectories;
  const auto& info = source.info();
  const std::size_t pixel =
      static_cast<std::size_t>(at.y) * static_cast<std::size_t>(info.width) + static_cast<std::size_t>(at.x);
  const float scale = static_cast<float>(255 * kValuesPerLevel / info.white);
  const int length = source.chunk_frames();
  for (int t = begin; t < end;) {
    const int stop = std::min(end, (t / length + 1) * length);
    const std::size_t skip = pixel * source.course() + static_cast<std::size_t>((t % length) * info.channels);
    const auto n = static_cast<std::size_t>((stop - t) * info.channels);
    const std::byte* chunk = source.chunk(t / length);
    if (info.depth == CV_8U)
      convert_bytes(chunk, skip, n, out);
    else if (info.depth == CV_16U)
      convert<std::uint16_t>(chunk, skip, n, scale, out);
    else
      convert<float>(chunk, skip, n, scale, out);
    out += n;
    t = stop;
  }
}

std::int64_t squared_step(const CourseValue* a, const CourseValue* b, std::size_t n) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < n; i += kValuesSummed)
    sum += squared_step_of_few(a + i, b + i, std::min(kValuesSummed, n - i));
  return sum;
}

}  // namespace emberfold::dytex::detail
