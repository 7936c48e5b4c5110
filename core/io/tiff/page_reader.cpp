// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/page_reader.hpp"

#include <algorithm>
#include <bit>
#include <cstdarg>
#include <cstring>
#include <set>
#include <utility>

#include <opencv2/core.hpp>
#include <tiffio.h>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/tiff/samples.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// A page that cannot be decoded; the caller writes the message.
struct Undecodable {};

void require(bool holds) {
  if (!holds) throw Undecodable();
}

/// Suppresses a message of libtiff.
int quiet(TIFF*, void*, const char*, const char*, std::va_list) {
  return 1;
}

TIFF* open_tiff(const fs::path& path) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), quiet, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), quiet, nullptr);
  // No memory map (a file may shrink while it is read), and strips as stored.
  return TIFFOpenExt(path.c_str(), "rmc", options.get());
}

/// Rows of the file; samples that are stored together are adjacent.
struct Block {
  const std::uint8_t* bytes = nullptr;
  std::size_t row_bytes = 0;
  int x = 0, y = 0, columns = 0, rows = 0;
  std::size_t together = 1;  ///< samples of one pixel
};

template <class Stored, class Value>
void take_values(const std::uint8_t* from, std::size_t step, int count, Value* to, int channels) {
  for (int i = 0; i < count; ++i, from += step * sizeof(Stored), to += channels) {
    Stored value;
    std::memcpy(&value, from, sizeof value);
    *to = static_cast<Value>(value);
  }
}

/// Converts values that are read as floats: real ones, signed ones, and whole ones of 32 bits.
void take_floats(const std::uint8_t* from, const Block& block, const TiffPage& page, float* to,
                 int channels) {
  const auto take = [&]<class Stored>(Stored) {
    take_values<Stored>(from, block.together, block.columns, to, channels);
  };
  if (page.format == SAMPLEFORMAT_IEEEFP)
    page.bits == 64 ? take(double{}) : page.bits == 16 ? take(cv::float16_t(0.F)) : take(float{});
  else if (page.format == SAMPLEFORMAT_INT)
    page.bits == 8 ? take(std::int8_t{}) : page.bits == 16 ? take(std::int16_t{}) : take(std::int32_t{});
  else
    take(std::uint32_t{});
}

/// Unpacks values that are not whole bytes: the highest bit is first; below 8 bits they are spread to 8.
template <class Value>
void take_bits(const std::uint8_t* row, std::size_t first, std::size_t step, int count, unsigned bits,
               Value* to, int channels) {
  const unsigned top = (1U << bits) - 1;
  for (int i = 0; i < count; ++i, first += step, to += channels) {
    unsigned value = 0;
    for (std::size_t bit = first * bits; bit < (first + 1) * bits; ++bit)
      value = value << 1U | (row[bit / 8] >> (7 - bit % 8) & 1U);
    *to = static_cast<Value>(bits < 8 ? value * 255 / top : value);
  }
}

/// Puts sample `sample` of those stored together into channel `channel` of the picture.
void put(const Block& block, std::size_t sample, const TiffPage& page, int channel, cv::Mat& picture) {
  const int channels = picture.channels();
  for (int y = 0; y < block.rows; ++y) {
    const std::uint8_t* row = block.bytes + static_cast<std::size_t>(y) * block.row_bytes;
    const std::uint8_t* from = row + sample * page.bits / 8;
    const int at = block.x * channels + channel;
    const auto bits = static_cast<unsigned>(page.bits);
    if (picture.depth() == CV_32F)
      take_floats(from, block, page, picture.ptr<float>(block.y + y) + at, channels);
    else if (bits == 16)
      take_values<std::uint16_t>(from, block.together, block.columns,
                                 picture.ptr<std::uint16_t>(block.y + y) + at, channels);
    else if (bits == 8)
      take_values<std::uint8_t>(from, block.together, block.columns,
                                picture.ptr<std::uint8_t>(block.y + y) + at, channels);
    else if (picture.depth() == CV_16U)
      take_bits(row, sample, block.together, block.columns, bits,
                picture.ptr<std::uint16_t>(block.y + y) + at, channels);
    else
      take_bits(row, sample, block.together, block.columns, bits, picture.ptr<std::uint8_t>(block.y + y) + at,
                channels);
  }
}

/// Decodes the strips or tiles of one plane (of all samples where they are stored together), one after the
/// other.
template <class Use>
void each_block(TIFF* file, const TiffPage& page, int plane, const Use& use) {
  const bool is_tiled = TIFFIsTiled(file) != 0;
  auto width = static_cast<std::uint32_t>(page.width), height = static_cast<std::uint32_t>(page.height);
  std::uint32_t block_width = width, block_height = height;
  if (is_tiled)
    require(TIFFGetField(file, TIFFTAG_TILEWIDTH, &block_width) == 1 &&
            TIFFGetField(file, TIFFTAG_TILELENGTH, &block_height) == 1);
  else
    TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &block_height);
  const tmsize_t row_bytes = is_tiled ? TIFFTileRowSize(file) : TIFFScanlineSize(file);
  const tmsize_t size = is_tiled ? TIFFTileSize(file) : TIFFStripSize(file);
  constexpr tmsize_t kLargest = tmsize_t{1} << 33;  // bytes; a page has at most 2^30 pixels
  Block block;
  block.together = page.planes == 2 ? 1 : page.samples;
  const std::uint64_t needed = (std::uint64_t{block_width} * block.together * page.bits + 7) / 8;
  require(block_width > 0 && block_height > 0 && size > 0 && size <= kLargest && row_bytes > 0 &&
          static_cast<std::uint64_t>(row_bytes) >= needed);
  block_height = std::min(block_height, is_tiled ? block_height : height);
  block.row_bytes = static_cast<std::size_t>(row_bytes);
  const auto buffer = std::make_unique_for_overwrite<std::uint8_t[]>(static_cast<std::size_t>(size));
  block.bytes = buffer.get();
  for (std::uint64_t y = 0; y < height; y += block_height)
    for (std::uint64_t x = 0; x < width; x += block_width) {
      const auto left = static_cast<std::uint32_t>(x), top = static_cast<std::uint32_t>(y);
      const auto sample = static_cast<std::uint16_t>(plane);
      block.x = static_cast<int>(x), block.y = static_cast<int>(y);
      block.columns = static_cast<int>(std::min(block_width, width - left));
      block.rows = static_cast<int>(std::min(block_height, height - top));
      const tmsize_t got =
          is_tiled
              ? TIFFReadEncodedTile(file, TIFFComputeTile(file, left, top, 0, sample), buffer.get(), size)
              : TIFFReadEncodedStrip(file, TIFFComputeStrip(file, top, sample), buffer.get(), size);
      require(got >= block.rows * row_bytes);
      use(block);
    }
}

/// Reads a page without a head, each plane of which is one block.
template <class Use>
void bare_block(std::ifstream& in, const TiffPage& page, int plane, const Use& use) {
  Block block;
  block.together = page.planes == 2 ? 1 : page.samples;
  block.columns = static_cast<int>(page.width), block.rows = static_cast<int>(page.height);
  block.row_bytes = page.width * block.together * (page.bits / 8);
  const std::size_t size = block.row_bytes * page.height;
  const auto buffer = std::make_unique_for_overwrite<std::uint8_t[]>(size);
  in.clear();
  in.seekg(static_cast<std::streamoff>(page.offset + size * static_cast<std::size_t>(plane)));
  require(
      static_cast<bool>(in.read(reinterpret_cast<char*>(buffer.get()), static_cast<std::streamsize>(size))));
  const std::size_t each = page.bits / 8;
  if (page.little_endian != (std::endian::native == std::endian::little))
    for (std::size_t at = 0; at < size; at += each) std::reverse(buffer.get() + at, buffer.get() + at + each);
  block.bytes = buffer.get();
  use(block);
}

/// Selects the page in the handle, and checks that libtiff reads its head as it was read here.
void select_page(TIFF* file, const TiffPage& page) {
  require(file != nullptr && TIFFSetSubDirectory(file, page.head) == 1);
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, planes = 1;
  TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(file, TIFFTAG_IMAGELENGTH, &height);
  TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &planes);
  require(width == page.width && height == page.height && bits == page.bits && samples == page.samples &&
          (samples == 1 || (planes == PLANARCONFIG_SEPARATE) == (page.planes == 2)));
}

/// Returns a picture whose colours libtiff converts.
cv::Mat converted_picture(TIFF* file, const TiffPage& page) {
  cv::Mat picture(static_cast<int>(page.height), static_cast<int>(page.width), CV_8UC3);
  const auto pixels = std::make_unique_for_overwrite<std::uint32_t[]>(page.width * page.height);
  require(TIFFReadRGBAImageOriented(file, static_cast<std::uint32_t>(page.width),
                                    static_cast<std::uint32_t>(page.height), pixels.get(),
                                    static_cast<int>(page.orientation), 1) == 1);
  std::size_t at = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x, ++at)
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<std::uint8_t>(TIFFGetB(pixels[at])),
                                              static_cast<std::uint8_t>(TIFFGetG(pixels[at])),
                                              static_cast<std::uint8_t>(TIFFGetR(pixels[at])));
  return picture;
}

}  // namespace

void PageReader::Close::operator()(tiff* file) const {
  TIFFClose(file);
}

PageReader::PageReader(fs::path path)
    : path_(std::move(path)), file_(open_tiff(path_)), bytes_(open_file(path_)) {}

cv::Mat PageReader::read(const TiffPage& page) {
  const auto fail = [&](const std::string& what) {
    throw core::IoError("cannot read " + path_.string() + ": " + what);
  };
  const std::string named = "page " + std::to_string(page.index);
  try {
    const SampleMeaning meaning = meaning_of(page);
    if (!page.raw) select_page(file_.get(), page);
    if (meaning.is_converted) return upright_picture(converted_picture(file_.get(), page), page, meaning);
    const auto samples = samples_of(page, meaning);
    cv::Mat picture(static_cast<int>(page.height), static_cast<int>(page.width),
                    CV_MAKETYPE(meaning.depth, static_cast<int>(samples.size())));
    const auto take = [&](int first, int count, int plane) {
      const auto use = [&](const Block& block) {
        for (int channel = first; channel < first + count; ++channel) {
          const int sample = page.planes == 2 ? 0 : samples[static_cast<std::size_t>(channel)];
          put(block, static_cast<std::size_t>(sample), page, channel, picture);
        }
      };
      page.raw ? bare_block(bytes_, page, plane, use) : each_block(file_.get(), page, plane, use);
    };
    if (page.planes != 2) take(0, picture.channels(), 0);
    for (int channel = 0; page.planes == 2 && channel < picture.channels(); ++channel)
      take(channel, 1, samples[static_cast<std::size_t>(channel)]);
    return upright_picture(picture, page, meaning);
  } catch (const Undecodable&) {
    fail(named + " cannot be decoded");
  }
  return {};
}

std::vector<TiffPage> read_picture_pages(const fs::path& path, const core::Warn& warn) {
  auto pages = read_tiff_pages(path, warn);
  const auto in_file = pages.size();
  const std::string description = pages.front().description;
  std::erase_if(pages, [](const TiffPage& page) { return !page.is_picture(); });
  if (pages.empty()) throw core::IoError("cannot read " + path.string() + ": it holds no picture");
  pages.front().description = description;
  const auto say = [&](const std::string& what) {
    if (warn) warn(path.string() + ": " + what);
  };
  if (pages.size() < in_file)
    say(std::to_string(in_file - pages.size()) +
        " of its pages are smaller copies or masks, and are passed over");
  std::set<std::string> printed;
  for (const TiffPage& page : pages) try {
      for (const auto& note : meaning_of(page).notes)
        if (printed.insert(note).second) say(note);
    } catch (const core::IoError& error) {
      throw core::IoError("cannot read " + path.string() + ": " + error.what());
    }
  return pages;
}

}  // namespace emberfold::io
