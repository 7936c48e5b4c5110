// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/overlap.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/math/simd_clones.hpp"
#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kBytesSummed = 1 << 14;  // values whose squares add up to less than 2^31
constexpr std::size_t kPlacesPerTask = 16;

// n ≤ 2^14, so that the sum fits.
EMBERFOLD_SIMD_CLONES
std::int32_t difference_of_bytes(const std::uint8_t* a, const std::uint8_t* b, std::size_t n) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto d = static_cast<std::int16_t>(a[i] - b[i]);
    sum += d * d;
  }
  return sum;
}

EMBERFOLD_SIMD_CLONES
std::uint64_t difference_of_words(const std::uint16_t* a, const std::uint16_t* b, std::size_t n) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t d = a[i] - b[i];
    const auto size = static_cast<std::uint32_t>(d < 0 ? -d : d);
    sum += size * size;  // below 2^32
  }
  return sum;
}

double difference_of_floats(const float* a, const float* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return sum;
}

}  // namespace

double squared_difference(const std::byte* a, const std::byte* b, std::size_t n, int depth) {
  if (depth == CV_16U)
    return static_cast<double>(difference_of_words(reinterpret_cast<const std::uint16_t*>(a),
                                                   reinterpret_cast<const std::uint16_t*>(b), n));
  if (depth == CV_32F)
    return difference_of_floats(reinterpret_cast<const float*>(a), reinterpret_cast<const float*>(b), n);
  std::int64_t sum = 0;
  const auto *left = reinterpret_cast<const std::uint8_t*>(a),
             *right = reinterpret_cast<const std::uint8_t*>(b);
  for (std::size_t i = 0; i < n; i += kBytesSummed)
    sum += difference_of_bytes(left + i, right + i, std::min(kBytesSummed, n - i));
  return static_cast<double>(sum);
}

Overlap::Overlap(std::span<const Trajectories* const> sources, std::vector<Run> runs,
                 std::vector<SourcePixel> pixels)
    : sources_(sources),
      runs_(std::move(runs)),
      pixels_(std::move(pixels)),
      bytes_(sources.front()->course() * CV_ELEM_SIZE1(sources.front()->info().depth)) {}

const std::byte* Overlap::at(const SourcePixel& pixel, int chunk) const {
  const Trajectories& source = *sources_[static_cast<std::size_t>(pixel.source)];
  const auto index = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(source.info().width) +
                     static_cast<std::size_t>(pixel.x);
  return source.chunk(chunk) + index * bytes_;
}

std::vector<std::byte> Overlap::gather(int chunk) const {
  std::vector<std::byte> values(pixels_.size() * bytes_);
  std::byte* out = values.data();
  for (const auto& pixel : pixels_) {
    std::memcpy(out, at(pixel, chunk), bytes_);
    out += bytes_;
  }
  return values;
}

std::vector<double> Overlap::errors(std::span<const SourcePixel> places, double limit) const {
  std::vector<double> errors(places.size(), 0.0);
  const int depth = sources_.front()->info().depth;
  const std::size_t course = sources_.front()->course();
  core::parallel_for((places.size() + kPlacesPerTask - 1) / kPlacesPerTask, {}, [&](std::size_t group) {
    const std::size_t first = group * kPlacesPerTask, last = std::min(first + kPlacesPerTask, places.size());
    for (int c = 0; c < sources_.front()->chunks(); ++c) {
      const auto there = gather(c);
      for (std::size_t i = first; i < last; ++i) {
        const std::byte* left = there.data();
        if (errors[i] > limit) continue;
        for (const Run& run : runs_) {
          const auto length = static_cast<std::size_t>(run.length);
          const SourcePixel begin{places[i].source, places[i].x + run.x, places[i].y + run.y};
          errors[i] += squared_difference(left, at(begin, c), length * course, depth);
          left += length * bytes_;
        }
      }
    }
  });
  return errors;
}

cv::Mat Overlap::picture(const SourcePixel& place, cv::Size block) const {
  cv::Mat errors = cv::Mat::zeros(block, CV_64F);
  const int depth = sources_.front()->info().depth;
  const std::size_t course = sources_.front()->course();
  for (int c = 0; c < sources_.front()->chunks(); ++c) {
    std::size_t i = 0;
    for (const Run& run : runs_)
      for (int x = run.x; x < run.x + run.length; ++x)
        errors.at<double>(run.y, x) += squared_difference(
            at(pixels_[i++], c), at({place.source, place.x + x, place.y + run.y}, c), course, depth);
  }
  return errors;
}

}  // namespace emberfold::dytex::detail
