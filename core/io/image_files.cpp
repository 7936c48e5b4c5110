// SPDX-License-Identifier: Apache-2.0
#include "core/io/image_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/tiff/page_reader.hpp"
#include "core/io/tiff/samples.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view digits_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(at, end - at);
}

std::string_view without_zeros(std::string_view digits) {
  const auto first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? digits.substr(digits.size()) : digits.substr(first);
}

/// Returns whether printf would write exactly `digits` for `number`.
bool prints_as(std::string_view digits, const PatternNumber& number) {
  if (digits.empty()) return false;
  const std::size_t least = std::max<std::size_t>(number.digits, 1);
  return digits.size() == least || (digits.size() > least && digits.front() != '0');
}

std::vector<fs::path> files_where(const fs::path& folder, const auto& wanted) {
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  std::vector<fs::path> files;
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code unknown;
    if (!name.starts_with('.') && wanted(name) && !entry->is_directory(unknown))
      files.push_back(entry->path());
  }
  if (error) throw core::IoError("cannot read the folder " + folder.string() + ": " + error.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

using Bytes = std::vector<std::uint8_t>;

std::uint32_t big_endian(const Bytes& bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
         std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

std::uint32_t crc32(const Bytes& bytes, std::size_t at, std::size_t count) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      t[i] = i;
      for (int bit = 0; bit < 8; ++bit) t[i] = (t[i] >> 1) ^ ((t[i] & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    return t;
  }();
  std::uint32_t crc = ~0U;
  for (std::size_t i = at; i < at + count; ++i) crc = table[(crc ^ bytes[i]) & 0xFFU] ^ (crc >> 8);
  return ~crc;
}

bool is_png(const Bytes& bytes) {
  constexpr std::array<std::uint8_t, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  return bytes.size() >= 29 && std::equal(signature.begin(), signature.end(), bytes.begin());
}

/// Describes the damage of a PNG or JPEG; empty for a sound file. The decoders would return the missing part
/// as grey or noise, or print a line of their own.
std::string damage(const Bytes& bytes) {
  if (is_png(bytes)) {
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
      const std::size_t length = big_endian(bytes, at);
      if (length > bytes.size() - at - 12) break;
      if (crc32(bytes, at + 4, length + 4) != big_endian(bytes, at + 8 + length)) return "it is damaged";
      if (big_endian(bytes, at + 4) == 0x49454E44) return {};  // IEND
      at += length + 12;
    }
    return "it is cut off";
  }
  if (bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF) {
    for (std::size_t at = bytes.size() - 1; at > 2; --at)
      if (bytes[at - 1] == 0xFF && bytes[at] == 0xD9) return {};  // end of image; some cameras append to it
    return "it is cut off";
  }
  return {};
}

[[noreturn]] void fail_image(const fs::path& path, const std::string& reason) {
  throw core::IoError("cannot read the image " + path.string() + ": " + reason);
}

cv::Mat decode(const fs::path& path, const Bytes& bytes, int flags) {
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    image.release();  // larger than the decoder allows, or a header that contradicts itself
  }
  if (image.empty()) fail_image(path, "it is no image that OpenCV can decode");
  return image;
}

ImageFile read_tiff_image(const fs::path& path, std::optional<int> channel) {
  ImageFile image;
  const auto note = [&](const std::string& line) {
    image.notes.push_back(line.substr(line.find(path.string()) + path.string().size() + 2));
  };
  const auto pages = read_picture_pages(path, note);
  TiffPage first = pages.front();
  choose_sample(path, first, channel, note);
  image.pixels = PageReader(path).read(first);
  image.pages = static_cast<int>(pages.size());
  return image;
}

}  // namespace

std::optional<PatternNumber> pattern_number(std::string_view pattern) {
  if (pattern.empty() || pattern.front() != '%') return std::nullopt;
  const std::string_view width = digits_at(pattern, 1);
  if (1 + width.size() >= pattern.size() || pattern[1 + width.size()] != 'd') return std::nullopt;
  std::size_t digits = 0;
  if (!width.empty()) {
    if (width.front() != '0' || width.size() > 3) return std::nullopt;
    std::from_chars(width.data(), width.data() + width.size(), digits);
  }
  return PatternNumber{width.size() + 2, digits};
}

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = digits_at(a, i), y = digits_at(b, j);
      const std::string_view p = without_zeros(x), q = without_zeros(y);
      if (p.size() != q.size()) return p.size() < q.size();
      if (p != q) return p < q;
      i += x.size();
      j += y.size();
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // 02 and 2 are equal as numbers but need an order
}

bool is_image_name(const fs::path& path) {
  static const std::set<std::string> known = {".bmp", ".dib", ".jp2", ".jpe",  ".jpeg", ".jpg",
                                              ".pbm", ".pgm", ".png", ".pnm",  ".ppm",  ".ras",
                                              ".sr",  ".stk", ".tif", ".tiff", ".webp"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return known.contains(extension);
}

bool is_pattern(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.find_first_of("*?") != std::string::npos) return true;
  for (auto at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1))
    if (pattern_number(std::string_view(name).substr(at))) return true;
  return false;
}

bool fits_pattern(std::string_view pattern, std::string_view name) {
  // One row of the usual table: reach[i] is whether the pattern so far can end before name[i].
  std::vector<bool> reach(name.size() + 1, false);
  reach[0] = true;
  while (!pattern.empty()) {
    std::vector<bool> next(name.size() + 1, false);
    std::size_t taken = 1;
    if (const auto number = pattern_number(pattern)) {
      taken = number->length;
      for (std::size_t i = 0; i < name.size(); ++i)
        for (std::size_t n = 1; reach[i] && n <= digits_at(name, i).size(); ++n)
          if (prints_as(name.substr(i, n), *number)) next[i + n] = true;
    } else if (pattern.front() == '*') {
      next[0] = reach[0];
      for (std::size_t i = 0; i < name.size(); ++i) next[i + 1] = next[i] || reach[i + 1];
    } else {
      if (pattern.starts_with("%%")) taken = 2;
      for (std::size_t i = 0; i < name.size(); ++i)
        next[i + 1] = reach[i] && (pattern.front() == '?' || pattern.front() == name[i]);
    }
    reach = std::move(next);
    pattern.remove_prefix(taken);
  }
  return reach.back();
}

std::vector<fs::path> list_images(const fs::path& folder) {
  auto files = files_where(folder, [](const std::string& name) { return is_image_name(name); });
  if (files.empty()) throw core::IoError("the folder " + folder.string() + " holds no images");
  return files;
}

std::vector<fs::path> match_images(const fs::path& pattern) {
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  const std::string last = pattern.filename().string();
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw core::IoError("no file fits " + pattern.string() + ": there is no folder " + folder.string());
  auto files = files_where(folder, [&](const std::string& name) { return fits_pattern(last, name); });
  if (files.empty()) throw core::IoError("no file fits " + pattern.string());
  return files;
}

ImageFile read_image(const fs::path& path, std::optional<int> channel) {
  if (is_tiff(path)) return read_tiff_image(path, channel);
  std::ifstream in = open_file(path);
  std::error_code error;
  Bytes bytes(fs::file_size(path, error));
  if (error) fail_image(path, error.message());
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) fail_image(path, "reading stopped half way");
  if (bytes.empty()) fail_image(path, "it is empty");
  if (const std::string what = damage(bytes); !what.empty()) fail_image(path, what);

  // Asking for any colour drops alpha and honours EXIF orientation; asking for the pixels unchanged shows the
  // alpha but not the orientation. A PNG's header shows its alpha, which saves the second decoding.
  ImageFile image{decode(path, bytes, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR)};
  const int png_colour = is_png(bytes) ? bytes[25] : -1;
  const bool may_hide_alpha = png_colour < 0 && image.pixels.channels() == 3 && bytes[0] != 0xFF;
  if (png_colour == 4 || png_colour == 6 ||
      (may_hide_alpha && decode(path, bytes, cv::IMREAD_UNCHANGED).channels() == 4))
    image.notes.emplace_back(kAlphaDropped);
  if (png_colour == 4) cv::extractChannel(image.pixels.clone(), image.pixels, 0);  // grey with alpha
  if (image.pixels.depth() != CV_8U && image.pixels.depth() != CV_16U && image.pixels.depth() != CV_32F)
    fail_image(path, "its values have neither 8 nor 16 bits, nor are they floats");
  return image;
}

}  // namespace emberfold::io
