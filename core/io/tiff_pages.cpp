// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff_pages.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <span>
#include <string_view>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/tiff/axes.hpp"

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
  kPhotometric = 262,
  kDescription = 270,
  kStripOffsets = 273,
  kOrientation = 274,
  kSamples = 277,
  kStripBytes = 279,
  kResolutionX = 282,
  kResolutionY = 283,
  kPlanes = 284,
  kTileOffsets = 324,
  kTileBytes = 325,
  kExtra = 338,
  kFormat = 339,
  kStack = 33629  // MetaMorph: one entry a picture
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

/// Reports that the file ends too early.
struct CutOff : core::IoError {
  using IoError::IoError;
};

/// A page, and whether its pixels are inside the file.
struct FoundPage {
  TiffPage page;
  bool is_whole = true;
};

class TiffReader {
 public:
  TiffReader(const fs::path& path, const core::Warn& warn) : path_(path), warn_(warn), in_(open_file(path)) {
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
    auto found = chain(at);
    const auto broken = std::ranges::find(found, false, &FoundPage::is_whole);
    std::vector<TiffPage> pages;
    for (auto it = found.begin(); it != broken; ++it) pages.push_back(std::move(it->page));
    if (pages.empty()) fail_cut();
    const std::uint64_t planned = std::max(std::uint64_t{found.size()}, planned_pages(pages.front()));
    if (found.size() == 1) add_raw_pages(pages);
    if (broken != found.end() || chain_is_cut_) warn_of_end(pages.size(), planned);
    if (description_is_lost_) warn("its description is cut off; every page is taken as a frame");
    spread_planes(pages);
    for (std::size_t i = 0; i < pages.size(); ++i) pages[i].index = static_cast<int>(i);
    return pages;
  }

 private:
  struct Entry {
    std::uint64_t tag = 0, type = 0, count = 0, at = 0;  ///< at: position of its values
  };

  [[noreturn]] void fail(const std::string& reason) const {
    throw core::IoError("cannot read " + path_.string() + ": " + reason);
  }
  [[noreturn]] void fail_cut() const { throw CutOff("cannot read " + path_.string() + ": it is cut off"); }
  void warn(const std::string& what) const {
    if (warn_) warn_(path_.string() + ": " + what);
  }

  void warn_of_end(std::size_t whole, std::uint64_t planned) const {
    const std::string read = std::to_string(whole);
    warn(planned > whole
             ? "it ends early: " + read + " of its " + std::to_string(planned) +
                   " pages are whole and are read, " + std::to_string(planned - whole) + " are missing"
             : "it ends early: its first " + read +
                   " pages are whole and are read, an unknown number is missing");
  }

  /// Follows the chain of heads that begins at `at`, to its end or to that of the file.
  std::vector<FoundPage> chain(std::uint64_t at) {
    std::vector<FoundPage> found;
    std::set<std::uint64_t> seen;
    while (at != 0) {
      if (!seen.insert(at).second) fail("it is damaged: its pages follow each other in a circle");
      is_first_ = found.empty();
      try {
        found.push_back(page(at));
      } catch (const CutOff&) {
        if (found.empty()) throw;
        chain_is_cut_ = true, link_ = at;
        return found;
      }
    }
    if (found.empty()) fail("it holds no page");
    return found;
  }

  std::vector<std::uint8_t> bytes(std::uint64_t at, std::uint64_t count) {
    if (at > size_ || count > size_ - at) fail_cut();
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
  FoundPage page(std::uint64_t& at) {
    const std::uint64_t count_bytes = big_ ? 8 : 2, entry_bytes = big_ ? 20 : 12, next_bytes = big_ ? 8 : 4;
    const std::uint64_t count = number_at(at, count_bytes);
    if (count > size_ / entry_bytes) fail_cut();
    const std::uint64_t begin = at + count_bytes;
    const auto table = bytes(begin, count * entry_bytes);
    TiffPage page;
    page.little_endian = little_, page.head = at, page.photometric = kNone;
    std::vector<std::uint64_t> offsets, sizes;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto head = std::span(table).subspan(i * entry_bytes, entry_bytes);
      take(entry(head, begin + i * entry_bytes), page, offsets, sizes);
    }
    if (page.photometric == kNone) page.photometric = page.samples - page.extra.size() >= 3 ? 2 : 1;
    if (!offsets.empty()) page.offset = offsets.front();
    const bool is_whole = check(page, offsets, sizes);
    at = number_at(begin + count * entry_bytes, next_bytes);
    return {std::move(page), is_whole};
  }

  Entry entry(std::span<const std::uint8_t> head, std::uint64_t at) {
    const std::uint64_t count_bytes = big_ ? 8 : 4;
    Entry found{number(head.subspan(0, 2)), number(head.subspan(2, 2)), number(head.subspan(4, count_bytes)),
                at + 4 + count_bytes};
    const std::uint64_t each = type_bytes(found.type);
    if (each > 0 && found.count > size_ / each) fail_cut();
    if (each * found.count > count_bytes) found.at = number_at(found.at, count_bytes);  // stored elsewhere
    return found;
  }

  std::uint64_t first_value(const Entry& entry) {
    const std::uint64_t each = type_bytes(entry.type);
    if (each == 0 || entry.count == 0)
      fail("it is damaged: tag " + std::to_string(entry.tag) + " has no number");
    if (entry.at > size_ || each * entry.count > size_ - entry.at) fail_cut();
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

  /// Returns a whole number divided by another; 0 where there is none.
  double ratio(const Entry& entry) {
    if (entry.type != kRatio || entry.count == 0) return 0;
    const auto all = bytes(entry.at, 8);
    const auto below = static_cast<double>(number(std::span(all).subspan(4, 4)));
    return below > 0 ? static_cast<double>(number(std::span(all).first(4))) / below : 0;
  }

  /// Returns the times of the pictures of a MetaMorph stack: six numbers each, of which the third is the day
  /// and the fourth the ms of that day; nothing where the file ends too early.
  std::vector<double> stack_times(const Entry& entry) {
    constexpr std::uint64_t kPicture = 24, kDay = 8, kMs = 12;  // bytes
    if (entry.at > size_ || entry.count > (size_ - entry.at) / kPicture) return {};
    const auto all = bytes(entry.at, kPicture * entry.count);
    std::vector<double> times;
    for (std::uint64_t at = 0; at < all.size(); at += kPicture)
      times.push_back(86400. * static_cast<double>(number(std::span(all).subspan(at + kDay, 4))) +
                      static_cast<double>(number(std::span(all).subspan(at + kMs, 4))) / 1000);
    return times;
  }

  std::string text(const Entry& entry) {
    description_is_lost_ = entry.at > size_ || entry.count > size_ - entry.at;
    if (entry.type != kText || description_is_lost_) return {};
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
    constexpr std::array<Field, 10> kFields{{{kSubfile, &TiffPage::subfile},
                                             {kWidth, &TiffPage::width},
                                             {kHeight, &TiffPage::height},
                                             {kBits, &TiffPage::bits},
                                             {kCompression, &TiffPage::compression},
                                             {kPhotometric, &TiffPage::photometric},
                                             {kOrientation, &TiffPage::orientation},
                                             {kSamples, &TiffPage::samples},
                                             {kPlanes, &TiffPage::planes},
                                             {kFormat, &TiffPage::format}}};
    for (const Field& field : kFields)
      if (entry.tag == field.tag) page.*field.value = first_value(entry);
    if (entry.tag == kStripOffsets || entry.tag == kTileOffsets) offsets = values(entry);
    if (entry.tag == kStripBytes || entry.tag == kTileBytes) sizes = values(entry);
    if (entry.tag == kExtra) page.extra = values(entry);
    if (entry.tag == kStack) page.stacked = entry.count, page.times = stack_times(entry);
    if (entry.tag == kDescription && is_first_) page.description = text(entry);
    if (entry.tag == kResolutionX) page.pixels_a_unit = ratio(entry);
    if (entry.tag == kResolutionY && page.pixels_a_unit > 0)
      if (const double down = ratio(entry); down > 0) page.aspect = down / page.pixels_a_unit;
  }

  /// Returns the number of pages that the first head declares, by its description or by the room up to the
  /// heads that come last; 0: unknown.
  [[nodiscard]] std::uint64_t planned_pages(const TiffPage& first) const {
    if (first.stacked > 1) return first.stacked;
    const std::uint64_t described = pages_by_head(first);
    if (described > 0 || !description_is_lost_ || link_ < first.offset) return described;
    return first.compression == 1 && first.stored_bytes > 0 ? (link_ - first.offset) / first.stored_bytes : 0;
  }

  /// Lists the pictures after the first page that have no heads: of a MetaMorph stack; of ImageJ's large
  /// stacks; where the file ends before the heads, which some programs write last.
  void add_raw_pages(std::vector<TiffPage>& pages) {
    const TiffPage first = pages.front();
    const bool is_stack = first.stacked > 1;
    const std::uint64_t images = planned_pages(first);
    if (images < 2) return;
    if (is_stack && first.compression != 1)
      fail("it is a MetaMorph stack of " + std::to_string(images) +
           " compressed pictures; read are stacks without compression");
    const std::uint64_t each = first.width * first.height * first.samples * first.bits / 8;
    if (first.compression != 1 || first.bits % 8 != 0 || first.stored_bytes != each) return;
    const bool may_lack_heads = is_stack || !first.description.starts_with('<');  // OME: of several files
    if (link_ == 0 ? !may_lack_heads : link_ < first.offset || (link_ - first.offset) / each < images) return;
    const std::uint64_t whole = std::min(images, (size_ - first.offset) / each);
    chain_is_cut_ = whole < images;
    pages.clear();
    for (std::uint64_t i = 0; i < whole; ++i) {
      pages.push_back(first);
      TiffPage& page = pages.back();
      page.offset += i * each, page.raw = true;
      if (i > 0) page.description.clear();
    }
  }

  /// Turns planes that the head lists as pages into pages: a short stack looks like one picture in colour.
  void spread_planes(std::vector<TiffPage>& pages) const {
    const TiffPage first = pages.front();
    if (pages.size() != 1 || first.planes != 2 || first.samples < 2 || first.photometric != 2) return;
    const std::string planes = "its " + std::to_string(first.samples) + " separate planes of " +
                               std::to_string(first.bits) + " bits";
    if (!lists_planes(first)) return warn(planes + " are taken as the colours of one picture");
    warn(planes + " are listed as pages by its head; they are read as pages, not as colours");
    pages.assign(first.samples, first);
    for (std::size_t i = 0; i < pages.size(); ++i) {
      pages[i].sample = static_cast<int>(i);
      if (i > 0) pages[i].description.clear();
    }
  }

  /// Returns whether all pixels are inside the file.
  bool check(TiffPage& page, const std::vector<std::uint64_t>& offsets,
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
      if (offsets[i] > size_ || bytes > size_ - offsets[i]) return false;
      page.stored_bytes += bytes;
    }
    const std::uint64_t row = (page.width * page.bits * page.samples + 7) / 8;
    if (page.compression == 1 && sizes.size() == offsets.size() && page.stored_bytes / row < page.height &&
        page.is_picture())
      fail("it is cut off: a page has fewer bytes than pixels");
    return true;
  }

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  fs::path path_;
  const core::Warn& warn_;
  std::ifstream in_;
  std::uint64_t size_ = 0, link_ = 0;  ///< link_: to a head after the file's end
  bool little_ = true, big_ = false, is_first_ = true, chain_is_cut_ = false, description_is_lost_ = false;
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

std::vector<TiffPage> read_tiff_pages(const fs::path& path, const core::Warn& warn) {
  return TiffReader(path, warn).pages();
}

}  // namespace emberfold::io
