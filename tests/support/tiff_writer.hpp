// SPDX-License-Identifier: Apache-2.0
// Writes TIFF stacks byte by byte, with the heads that microscopes' programs leave; no library has a part in
// it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace emberfold::test {

struct TiffHead {
  std::string description = {};
  std::uint32_t across = 0, down = 0, below = 1;  ///< pixels a unit: across / below; 0: not told
  bool big_endian = false;
  bool one_head = false;          ///< only the first page has a head; the pixels of the others follow its own
  std::uint64_t photometric = 1;  ///< 0: white is 0, 1: black is 0, 2: RGB, 3: palette (of no grey at all)
  bool separate = false;          ///< one sample of all pixels after the other
  std::vector<std::uint64_t> extra = {};     ///< of the last samples: 0 unknown, 1, 2 alpha
  std::uint64_t stacked = 0;                 ///< pictures of a MetaMorph stack
  std::vector<std::uint64_t> stack_ms = {};  ///< of a MetaMorph stack: times of its pictures, ms of the day
  bool without_photometric = false;
  bool description_is_lost = false;  ///< with heads_are_lost: it came last, too
  bool heads_are_lost =
      false;  ///< one head, then all pixels; the heads of the others came last and are cut off
};

class TiffWriter {
 public:
  TiffWriter(const std::vector<cv::Mat>& pages, const TiffHead& head) : pages_(pages), head_(head) {}

  std::string bytes() {
    text_ = head_.big_endian ? "MM" : "II";
    put(42, 2), put(0, 4);
    if (head_.heads_are_lost) return bytes_of_one_head();
    std::vector<std::size_t> pixels;
    for (const auto& page : pages_) pixels.push_back(put_pixels(page));
    std::size_t link = 4;
    const std::size_t heads = head_.one_head ? 1 : pages_.size();
    for (std::size_t i = 0; i < heads; ++i) link = put_head(pages_[i], pixels[i], i == 0, link);
    return text_;
  }

 private:
  std::string bytes_of_one_head() {
    const std::string begin = text_;
    put_head(pages_[0], 0, true, 4);
    const std::size_t size = text_.size();
    text_ = begin;
    const std::size_t link = put_head(pages_[0], size, true, 4);
    for (const auto& page : pages_) put_pixels(page);
    put_at(link, text_.size() + text_.size() % 2, 4);
    if (head_.description_is_lost) put_at(text_.find("\x0e\x01\x02") + 8, text_.size() + 99, 4);
    return text_;
  }
  void put(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
      text_ += static_cast<char>(value >> (8 * (head_.big_endian ? count - 1 - i : i)) & 0xFFU);
  }
  void put_at(std::size_t at, std::uint64_t value, int count) {
    const std::string before = text_;
    text_.clear();
    put(value, count);
    const std::string digits = text_;
    text_ = before;
    text_.replace(at, digits.size(), digits);
  }

  std::size_t put_pixels(const cv::Mat& page) {
    if (!head_.one_head && !head_.heads_are_lost && !head_.separate && text_.size() % 2 != 0) text_ += '\0';
    const std::size_t at = text_.size(), each = page.elemSize1();
    if (head_.separate && page.channels() > 1) {
      std::vector<cv::Mat> samples;
      cv::split(page, samples);
      for (const auto& sample : samples) put_pixels(sample);
      return at;
    }
    for (int y = 0; y < page.rows; ++y)
      for (std::size_t k = 0;
           k < static_cast<std::size_t>(page.cols) * static_cast<std::size_t>(page.channels()); ++k) {
        std::string value(reinterpret_cast<const char*>(page.ptr(y)) + k * each, each);
        if (head_.big_endian == (std::endian::native == std::endian::little)) std::ranges::reverse(value);
        text_ += value;
      }
    return at;
  }

  /// Returns what a head's entry holds: the values where they fit into it, otherwise their place.
  std::uint64_t put_shorts(const std::vector<std::uint64_t>& values) {
    if (values.size() == 1) return values[0];
    if (values.size() == 2) return values[0] | values[1] << 16U;
    if (text_.size() % 2 != 0) text_ += '\0';
    const std::size_t at = text_.size();
    for (const auto value : values) put(value, 2);
    return at;
  }
  std::uint64_t put_longs(const std::vector<std::uint64_t>& values) {
    if (values.size() == 1) return values[0];
    if (text_.size() % 2 != 0) text_ += '\0';
    const std::size_t at = text_.size();
    for (const auto value : values) put(value, 4);
    return at;
  }
  /// Green from dark to bright, as of a fluorescent dye.
  static std::vector<std::uint64_t> palette() {
    std::vector<std::uint64_t> colours(768, 0);
    for (std::size_t i = 0; i < 256; ++i) colours[256 + i] = 257 * i;
    return colours;
  }

  /// Returns where the place of the next head is to be written.
  std::size_t put_head(const cv::Mat& page, std::size_t pixels, bool first, std::size_t link) {
    struct Entry {
      std::uint64_t tag, type, count, value;
    };
    std::vector<Entry> entries;
    const auto rows = static_cast<std::uint64_t>(page.rows), cols = static_cast<std::uint64_t>(page.cols);
    entries.push_back({256, 3, 1, cols});
    entries.push_back({257, 3, 1, rows});
    const auto samples = static_cast<std::uint64_t>(page.channels());
    entries.push_back(
        {258, 3, samples, put_shorts(std::vector(samples, std::uint64_t{page.elemSize1() * 8}))});
    entries.push_back({259, 3, 1, 1});
    if (!head_.without_photometric) entries.push_back({262, 3, 1, head_.photometric});
    if (first && !head_.description.empty()) {
      const std::size_t at = text_.size();
      text_ += head_.description + '\0';
      entries.push_back({270, 2, head_.description.size() + 1, at});
    }
    const std::uint64_t strips = head_.separate ? samples : 1;
    const std::uint64_t strip = rows * cols * samples / strips * page.elemSize1();
    std::vector<std::uint64_t> places, sizes(strips, strip);
    for (std::uint64_t i = 0; i < strips; ++i) places.push_back(pixels + i * strip);
    entries.push_back({273, 4, strips, put_longs(places)});
    entries.push_back({277, 3, 1, samples});
    entries.push_back({278, 3, 1, rows});
    entries.push_back({279, 4, strips, put_longs(sizes)});
    for (const auto& [tag, value] : {std::pair{282, head_.across}, {283, head_.down}}) {
      if (value == 0) continue;
      if (text_.size() % 2 != 0) text_ += '\0';
      entries.push_back({static_cast<std::uint64_t>(tag), 5, 1, text_.size()});
      put(value, 4), put(head_.below, 4);
    }
    if (head_.separate) entries.push_back({284, 3, 1, 2});
    if (head_.photometric == 3) entries.push_back({320, 3, 768, put_shorts(palette())});
    if (!head_.extra.empty()) entries.push_back({338, 3, head_.extra.size(), put_shorts(head_.extra)});
    const int depth = page.depth();
    const bool is_real = depth == CV_16F || depth == CV_32F || depth == CV_64F;
    const std::uint64_t format = is_real ? 3 : depth == CV_8U || depth == CV_16U ? 1 : 2;
    entries.push_back({339, 3, samples, put_shorts(std::vector(samples, format))});
    if (head_.stacked > 0) {
      const std::size_t at = text_.size();
      for (std::uint64_t i = 0; i < 6 * head_.stacked; ++i)
        put(i % 6 == 3 && !head_.stack_ms.empty() ? head_.stack_ms.at(i / 6) : 1, 4);
      entries.push_back({33629, 5, head_.stacked, at});
    }
    if (text_.size() % 2 != 0) text_ += '\0';
    put_at(link, text_.size(), 4);
    put(entries.size(), 2);
    for (const auto& entry : entries) {
      put(entry.tag, 2), put(entry.type, 2), put(entry.count, 4);
      if (entry.type == 3 && entry.count < 3)
        put(entry.value & 0xFFFFU, 2), put(entry.value >> 16U, 2);
      else
        put(entry.value, 4);
    }
    put(0, 4);
    return text_.size() - 4;
  }

  const std::vector<cv::Mat>& pages_;
  TiffHead head_;
  std::string text_;
};

/// Writes pages of 8 bits, 16 bits or floats, uncompressed; their channels are the samples, in their order.
inline void write_tiff(const std::filesystem::path& path, const std::vector<cv::Mat>& pages,
                       const TiffHead& head = {}) {
  std::ofstream(path, std::ios::binary) << TiffWriter(pages, head).bytes();
}

}  // namespace emberfold::test
