// SPDX-License-Identifier: Apache-2.0
#include "apps/page/packed_text.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <new>
#include <vector>

#include <zlib.h>

#include "apps/pictures/still.hpp"
#include "core/error.hpp"

namespace emberfold::apps {

namespace {

std::int16_t wrap_to_16_bits(int value) {
  return static_cast<std::int16_t>(value);
}

// Deflates bytes. `strategy`: zlib's; noise has no repetitions worth a search.
std::string deflated_text(std::span<const unsigned char> bytes, int strategy) {
  if (bytes.size() > std::numeric_limits<uInt>::max())
    throw core::InputError("an image of " + std::to_string(bytes.size()) + " bytes is too large for a page");
  z_stream stream{};
  constexpr int kWindow = 15, kMemory = 9;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWindow, kMemory, strategy) != Z_OK)
    throw std::bad_alloc();
  std::vector<unsigned char> packed(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  stream.next_in = const_cast<unsigned char*>(bytes.data());  // zlib's type lacks const; it only reads
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);  // the buffer is large enough
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return base64(packed);
}

// Turns blue, green, red into lightness, orange, green by reversible steps (Malvar, Sullivan 2003).
void to_lightness_and_colour(std::span<std::int16_t> planes) {
  const std::size_t size = planes.size() / 3;
  for (std::size_t p = 0; p < size; ++p) {
    const int blue = planes[p], green = planes[size + p], red = planes[2 * size + p];
    const int orange = wrap_to_16_bits(red - blue), middle = wrap_to_16_bits(blue + (orange >> 1));
    const int greenness = wrap_to_16_bits(green - middle);
    planes[p] = wrap_to_16_bits(middle + (greenness >> 1));
    planes[size + p] = wrap_to_16_bits(orange);
    planes[2 * size + p] = wrap_to_16_bits(greenness);
  }
}

int median(int a, int b, int c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

// Writes differences from the neighbours' prediction, sign last: low bytes from `low` on, high ones from
// `high`.
void put_differences(std::span<const std::int16_t> plane, cv::Size size, unsigned char* low,
                     unsigned char* high) {
  const auto width = static_cast<std::size_t>(size.width);
  for (std::size_t p = 0; p < plane.size(); ++p) {
    const bool first_row = p < width, first_column = p % width == 0;
    const int left = first_column ? 0 : plane[p - 1], upper = first_row ? 0 : plane[p - width];
    const int corner = first_row || first_column ? 0 : plane[p - width - 1];
    const int difference =
        wrap_to_16_bits(plane[p] - median(left, upper, wrap_to_16_bits(left + upper - corner)));
    const auto code = static_cast<unsigned>(difference < 0 ? -2 * difference - 1 : 2 * difference);
    low[p] = static_cast<unsigned char>(code & 0xFF);
    high[p] = static_cast<unsigned char>(code >> 8);
  }
}

}  // namespace

std::string packed_bytes(std::span<const unsigned char> bytes) {
  return deflated_text(bytes, Z_DEFAULT_STRATEGY);
}

std::string packed_numbers(std::span<const double> numbers) {
  std::vector<unsigned char> bytes;
  bytes.reserve(numbers.size() * sizeof(double));
  for (const double number : numbers) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<unsigned char>(bits >> shift));
  }
  return deflated_text(bytes, Z_DEFAULT_STRATEGY);
}

std::string packed_image(std::span<const std::int16_t> values, cv::Size size) {
  const auto area = static_cast<std::size_t>(size.area());
  if (area == 0) throw core::InputError("a page takes no image without pixels");
  const std::size_t channels = values.size() / area;
  std::vector<std::int16_t> planes(values.size());
  for (std::size_t p = 0; p < area; ++p)
    for (std::size_t c = 0; c < channels; ++c) planes[c * area + p] = values[p * channels + c];
  if (channels == 3) to_lightness_and_colour(planes);
  std::vector<unsigned char> bytes(2 * values.size());
  for (std::size_t at = 0; at < values.size(); at += area)
    put_differences(std::span(planes).subspan(at, area), size, bytes.data() + at,
                    bytes.data() + values.size() + at);
  return deflated_text(bytes, Z_RLE);
}

}  // namespace emberfold::apps
