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
  bool one_head = false;  ///< only the first page has a head; the pixels of the others follow its own
};

class TiffWriter {
 public:
  TiffWriter(const std::vector<cv::Mat>& pages, const TiffHead& head) : pages_(pages), head_(head) {}

  std::string bytes() {
    text_ = head_.big_endian ? "MM" : "II";
    put(42, 2), put(0, 4);
    std::vector<std::size_t> pixels;
    for (const auto& page : pages_) pixels.push_back(put_pixels(page));
    std::size_t link = 4;
    const std::size_t heads = head_.one_head ? 1 : pages_.size();
    for (std::size_t i = 0; i < heads; ++i) link = put_head(pages_[i], pixels[i], i == 0, link);
    return text_;
  }

 private:
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
    if (!head_.one_head && text_.size() % 2 != 0) text_ += '\0';
    const std::size_t at = text_.size(), each = page.elemSize1();
    for (int y = 0; y < page.rows; ++y)
      for (std::size_t k = 0;
           k < static_cast<std::size_t>(page.cols) * static_cast<std::size_t>(page.channels()); ++k) {
        std::string value(reinterpret_cast<const char*>(page.ptr(y)) + k * each, each);
        if (head_.big_endian == (std::endian::native == std::endian::little)) std::ranges::reverse(value);
        text_ += value;
      }
    return at;
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
    entries.push_back({258, 3, 1, page.elemSize1() * 8});
    entries.push_back({259, 3, 1, 1});
    entries.push_back({262, 3, 1, 1});  // black is zero
    if (first && !head_.description.empty()) {
      const std::size_t at = text_.size();
      text_ += head_.description + '\0';
      entries.push_back({270, 2, head_.description.size() + 1, at});
    }
    entries.push_back({273, 4, 1, pixels});
    entries.push_back({277, 3, 1, 1});
    entries.push_back({278, 3, 1, rows});
    entries.push_back({279, 4, 1, rows * cols * page.elemSize1()});
    for (const auto& [tag, value] : {std::pair{282, head_.across}, {283, head_.down}}) {
      if (value == 0) continue;
      if (text_.size() % 2 != 0) text_ += '\0';
      entries.push_back({static_cast<std::uint64_t>(tag), 5, 1, text_.size()});
      put(value, 4), put(head_.below, 4);
    }
    entries.push_back({339, 3, 1, page.depth() == CV_32F ? 3U : 1U});
    if (text_.size() % 2 != 0) text_ += '\0';
    put_at(link, text_.size(), 4);
    put(entries.size(), 2);
    for (const auto& entry : entries) {
      put(entry.tag, 2), put(entry.type, 2), put(entry.count, 4);
      if (entry.type == 3)
        put(entry.value, 2), put(0, 2);
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

/// Writes grey pages of 8 bits, 16 bits or floats, uncompressed.
inline void write_tiff(const std::filesystem::path& path, const std::vector<cv::Mat>& pages,
                       const TiffHead& head = {}) {
  std::ofstream(path, std::ios::binary) << TiffWriter(pages, head).bytes();
}

}  // namespace emberfold::test
