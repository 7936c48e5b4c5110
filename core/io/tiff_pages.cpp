// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff_pages.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <set>
#include <span>
#include <string_view>

#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

// Tags and types of TIFF 6.0 (Adobe 1992, section 8), and of BigTIFF.
enum Tag : std::uint64_t {
  kSubfile = 254,
  kWidth = 256,
  kHeight = 257,
  kBits = 258,
  kCompression = 259,
  kDescription = 270,
  kStripOffsets = 273,
  kSamples = 277,
  kStripBytes = 279,
  kResolutionX = 282,
  kResolutionY = 283,
  kTileOffsets = 324,
  kTileBytes = 325,
  kFormat = 339
};
enum Type : std::uint64_t { kByte = 1, kText = 2, kShort = 3, kLong = 4, kRatio = 5, kLong8 = 16 };

std::uint64_t type_bytes(std::uint64_t type) {
  switch (type) {
    case kByte:
    case kText:
      return 1;
    case kShort:
      return 2;
    case kLong:
      return 4;
    case kRatio:
    case kLong8:
      return 8;
    default:
      return 0;
  }
}

class TiffReader {
 public:
  explicit TiffReader(const fs::path& path) : path_(path), in_(open_file(path)) {
    std::error_code error;
    size_ = fs::file_size(path, error);
    if (error) fail(error.message());
  }

  std::vector<TiffPage> pages() {
    const auto head = bytes(0, 8);
    little_ = head[0] == 'I';
    const auto version = number(std::span(head).subspan(2, 2));
    if ((head[0] != 'I' && head[0] != 'M') || head[0] != head[1] || (version != 42 && version != 43))
      fail("it is no TIFF");
    big_ = version == 43;
    std::uint64_t at = big_ ? number_at(8, 8) : number(std::span(head).subspan(4, 4));
    std::vector<TiffPage> found;
    std::set<std::uint64_t> seen;
    while (at != 0) {
      if (!seen.insert(at).second) fail("it is damaged: its pages follow each other in a circle");
      is_first_ = found.empty();
      found.push_back(page(at));
      found.back().index = static_cast<int>(found.size() - 1);
    }
    if (found.empty()) fail("it holds no page");
    add_raw_pages(found);
    return found;
  }

 private:
  struct Entry {
    std::uint64_t tag = 0, type = 0, count = 0, at = 0;  ///< at: where its values lie
  };

  [[noreturn]] void fail(const std::string& reason) const {
    throw core::IoError("cannot read the image " + path_.string() + ": " + reason);
  }

  std::vector<std::uint8_t> bytes(std::uint64_t at, std::uint64_t count) {
    if (at > size_ || count > size_ - at) fail("it is cut off");
    std::vector<std::uint8_t> found(count);
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(reinterpret_cast<char*>(found.data()), static_cast<std::streamsize>(count));
    if (!in_) fail("reading stopped half way");
    return found;
  }

  [[nodiscard]] std::uint64_t number(std::span<const std::uint8_t> digits) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < digits.size(); ++i)
      value = value << 8 | digits[little_ ? digits.size() - 1 - i : i];
    return value;
  }
  std::uint64_t number_at(std::uint64_t at, std::uint64_t count) { return number(bytes(at, count)); }

  /// Reads the page at `at` and sets `at` to the next one, 0 after the last.
  TiffPage page(std::uint64_t& at) {
    const std::uint64_t count_bytes = big_ ? 8 : 2, entry_bytes = big_ ? 20 : 12, next_bytes = big_ ? 8 : 4;
    const std::uint64_t count = number_at(at, count_bytes);
    if (count > size_ / entry_bytes) fail("it is cut off");
    const std::uint64_t begin = at + count_bytes;
    const auto table = bytes(begin, count * entry_bytes);
    TiffPage page;
    page.little_endian = little_;
    std::vector<std::uint64_t> offsets, sizes;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto head = std::span(table).subspan(i * entry_bytes, entry_bytes);
      take(entry(head, begin + i * entry_bytes), page, offsets, sizes);
    }
    check(page, offsets, sizes);
    if (!offsets.empty()) page.offset = offsets.front();
    at = number_at(begin + count * entry_bytes, next_bytes);
    return page;
  }

  Entry entry(std::span<const std::uint8_t> head, std::uint64_t at) {
    const std::uint64_t count_bytes = big_ ? 8 : 4;
    Entry found{number(head.subspan(0, 2)), number(head.subspan(2, 2)), number(head.subspan(4, count_bytes)),
                at + 4 + count_bytes};
    const std::uint64_t each = type_bytes(found.type);
    if (each > 0 && found.count > size_ / each) fail("it is cut off");
    if (each * found.count > count_bytes) found.at = number_at(found.at, count_bytes);  // they lie elsewhere
    return found;
  }

  std::uint64_t first_value(const Entry& entry) {
    const std::uint64_t each = type_bytes(entry.type);
    if (each == 0 || entry.count == 0)
      fail("it is damaged: tag " + std::to_string(entry.tag) + " has no number");
    return number_at(entry.at, each);
  }

  std::vector<std::uint64_t> values(const Entry& entry) {
    const std::uint64_t each = type_bytes(entry.type);
    const auto all = bytes(entry.at, each * entry.count);
    std::vector<std::uint64_t> found;
    for (std::uint64_t i = 0; each > 0 && i < entry.count; ++i)
      found.push_back(number(std::span(all).subspan(i * each, each)));
    return found;
  }

  /// A whole number above another; 0 where there is none.
  double ratio(const Entry& entry) {
    if (entry.type != kRatio || entry.count == 0) return 0;
    const auto all = bytes(entry.at, 8);
    const auto below = static_cast<double>(number(std::span(all).subspan(4, 4)));
    return below > 0 ? static_cast<double>(number(std::span(all).first(4))) / below : 0;
  }

  std::string text(const Entry& entry) {
    if (entry.type != kText) return {};
    const auto all = bytes(entry.at, entry.count);
    const std::string found(all.begin(), all.end());
    return found.substr(0, found.find('\0'));
  }

  void take(const Entry& entry, TiffPage& page, std::vector<std::uint64_t>& offsets,
            std::vector<std::uint64_t>& sizes) {
    struct Field {
      std::uint64_t tag;
      std::uint64_t TiffPage::*value;
    };
    constexpr std::array<Field, 7> kFields{{{kSubfile, &TiffPage::subfile},
                                            {kWidth, &TiffPage::width},
                                            {kHeight, &TiffPage::height},
                                            {kBits, &TiffPage::bits},
                                            {kCompression, &TiffPage::compression},
                                            {kSamples, &TiffPage::samples},
                                            {kFormat, &TiffPage::format}}};
    for (const Field& field : kFields)
      if (entry.tag == field.tag) page.*field.value = first_value(entry);
    if (entry.tag == kStripOffsets || entry.tag == kTileOffsets) offsets = values(entry);
    if (entry.tag == kStripBytes || entry.tag == kTileBytes) sizes = values(entry);
    if (entry.tag == kDescription && is_first_) page.description = text(entry);
    if (entry.tag == kResolutionX) page.pixels_a_unit = ratio(entry);
    if (entry.tag == kResolutionY && page.pixels_a_unit > 0)
      if (const double down = ratio(entry); down > 0) page.aspect = down / page.pixels_a_unit;
  }

  /// ImageJ writes one head and then the pixels of all pages, where they take more than 4 GB or are saved
  /// fast.
  void add_raw_pages(std::vector<TiffPage>& pages) const {
    const TiffPage first = pages.front();
    constexpr std::string_view kMark = "\nimages=";
    const auto at = first.description.find(kMark);
    if (pages.size() != 1 || !first.description.starts_with("ImageJ=") || at == std::string::npos) return;
    const std::uint64_t images = std::strtoull(first.description.c_str() + at + kMark.size(), nullptr, 10);
    const std::uint64_t each = first.width * first.height * first.samples * first.bits / 8;
    if (images < 2 || first.compression != 1 || first.bits % 8 != 0) return;
    if (each == 0 || images > (size_ - first.offset) / each) fail("it is cut off");
    pages.clear();
    for (std::uint64_t i = 0; i < images; ++i) {
      pages.push_back(first);
      TiffPage& page = pages.back();
      page.index = static_cast<int>(i), page.offset += i * each, page.stored_bytes = each, page.raw = true;
      if (i > 0) page.description.clear();
    }
  }

  void check(TiffPage& page, const std::vector<std::uint64_t>& offsets,
             const std::vector<std::uint64_t>& sizes) const {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 30;  // px; OpenCV takes no more
    if (page.width == 0 || page.height == 0 || page.width > kMost || page.height > kMost / page.width)
      fail("it is damaged: a page of " + std::to_string(page.width) + "x" + std::to_string(page.height) +
           " pixels");
    if (page.bits < 1 || page.bits > 64 || page.samples < 1 || page.samples > 65535)
      fail("it is damaged: its values have no size");
    if (offsets.empty() && page.is_picture()) fail("it is damaged: a page has no pixels");
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const std::uint64_t bytes = i < sizes.size() ? sizes[i] : 0;
      if (offsets[i] > size_ || bytes > size_ - offsets[i]) fail("it is cut off");
      page.stored_bytes += bytes;
    }
    const std::uint64_t row = (page.width * page.bits * page.samples + 7) / 8;
    if (page.compression == 1 && sizes.size() == offsets.size() && page.stored_bytes / row < page.height &&
        page.is_picture())
      fail("it is cut off: a page has fewer bytes than pixels");
  }

  fs::path path_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  bool little_ = true, big_ = false, is_first_ = true;
};

}  // namespace

bool is_tiff(const fs::path& path) {
  std::array<char, 4> head{};
  std::ifstream in(path, std::ios::binary);
  if (!in.read(head.data(), head.size())) return false;
  const std::string_view text(head.data(), head.size());
  using namespace std::string_view_literals;
  return text == "II*\0"sv || text == "MM\0*"sv || text == "II+\0"sv || text == "MM\0+"sv;
}

std::vector<TiffPage> read_tiff_pages(const fs::path& path) {
  return TiffReader(path).pages();
}

}  // namespace emberfold::io
