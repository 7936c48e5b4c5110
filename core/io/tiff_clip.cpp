// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/media_log.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

// Pages are decoded in ranges of at most so many bytes: to reach a range the decoder walks through all pages
// before it, so that single pages would cost a time that grows with the square of their number.
constexpr std::uint64_t kRangeBytes = std::uint64_t{64} << 20;
constexpr std::size_t kRangePages = 1024;

/// Keeps what OpenCV prints about a damaged page off standard error while it lives.
class SilentErrors {
 public:
  SilentErrors() : kept_(std::cerr.rdbuf(nullptr)) {}
  ~SilentErrors() {
    std::cerr.rdbuf(kept_);
    std::cerr.clear();
  }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
  std::streambuf* kept_;
};

class TiffClip final : public FrameDecoder {
 public:
  TiffClip(fs::path path, std::vector<TiffPage> pages, bool grey, const core::Warn& warn)
      : path_(std::move(path)), pages_(std::move(pages)), grey_(grey) {
    check_pages();
    const TiffPage& first = pages_.front();
    const std::uint64_t page_bytes = first.width * first.height * first.samples * ((first.bits + 7) / 8);
    range_ = std::clamp<std::size_t>(kRangeBytes / std::max<std::uint64_t>(1, page_bytes), 1, kRangePages);
    if (warn && (first.samples == 2 || first.samples == 4))
      warn(path_.string() + ": the alpha channel of its pages is dropped");
    const cv::Mat frame = next();
    position_ = 0;
    info_.width = frame.cols;
    info_.height = frame.rows;
    info_.channels = frame.channels();
    info_.depth = frame.depth();
    info_.frames = static_cast<std::int64_t>(pages_.size());
    if (info_.depth != CV_8U) info_.white = find_white();
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    if (position_ == pages_.size()) return {};
    if (position_ < held_from_ || position_ >= held_from_ + held_.size()) read_range();
    cv::Mat frame = held_[position_++ - held_from_].clone();
    return grey_ ? to_grey(frame) : frame;
  }

  bool skip() override {
    if (position_ == pages_.size()) return false;
    ++position_;
    return true;
  }

  void rewind() override { position_ = 0; }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw core::IoError("cannot read " + path_.string() + ": " + reason);
  }

  void check_pages() const {
    const TiffPage& first = pages_.front();
    const auto text = [](const TiffPage& page) {
      return std::to_string(page.width) + "x" + std::to_string(page.height) + " pixels of " +
             std::to_string(page.samples) + " x " + std::to_string(page.bits) + " bits";
    };
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      const TiffPage& page = pages_[i];
      if (page.width != first.width || page.height != first.height || page.bits != first.bits ||
          page.samples != first.samples || page.format != first.format)
        fail("page " + std::to_string(i) + " is " + text(page) + ", the first " + text(first));
    }
    // OpenCV would take the bits of large or signed whole numbers for those of other kinds.
    const bool real = first.format == 3 && (first.bits == 32 || first.bits == 64);
    if (!real && (first.format != 1 || first.bits > 16))
      fail("its values are " +
           std::string(first.format == 3   ? "floating-point numbers of "
                       : first.format == 2 ? "signed numbers of "
                                           : "whole numbers of ") +
           std::to_string(first.bits) + " bits; read are 8 and 16 bits without sign, and 32-bit floats");
  }

  /// Decodes the pages from `position_` on.
  void read_range() {
    const std::size_t count = std::min(range_, pages_.size() - position_);
    const int first = pages_[position_].index, last = pages_[position_ + count - 1].index;
    std::vector<cv::Mat> found;
    try {
      const SilentErrors silent;
      cv::imreadmulti(path_.string(), found, first, last - first + 1,
                      cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
    } catch (const cv::Exception&) {  // the page that it stopped at is missing
    }
    held_.clear();
    held_from_ = position_;
    for (std::size_t i = position_; i < position_ + count; ++i) {
      const auto at = static_cast<std::size_t>(pages_[i].index - first);
      if (at >= found.size() || found[at].empty()) fail("page " + std::to_string(i) + " cannot be decoded");
      held_.push_back(checked(std::move(found[at]), i));
    }
  }

  [[nodiscard]] cv::Mat checked(cv::Mat page, std::size_t index) const {
    const auto refuse = [&](const std::string& what) { fail("page " + std::to_string(index) + " " + what); };
    if (page.depth() == CV_64F) page.convertTo(page, CV_32F);
    if (page.depth() != CV_8U && page.depth() != CV_16U && page.depth() != CV_32F)
      refuse("holds neither 8 nor 16 bits nor floats");
    if (page.channels() != 1 && page.channels() != 3)
      refuse("has " + std::to_string(page.channels()) + " channels; read are 1 and 3");
    if (info_.width > 0 && (page.cols != info_.width || page.rows != info_.height ||
                            page.depth() != info_.depth || (!grey_ && page.channels() != info_.channels)))
      refuse("is of another size or kind than the first");
    if (page.depth() == CV_32F && !cv::checkRange(page)) refuse("holds a value that is no finite number");
    return page;
  }

  /// 2^b − 1, b the bits that the largest value needs: at least 8, and for floats up to 1 it is 1.
  double find_white() {
    double largest = 0;
    for (cv::Mat frame = next(); !frame.empty(); frame = next()) {
      double most = 0;
      cv::minMaxLoc(frame.reshape(1), nullptr, &most);
      largest = std::max(largest, most);
    }
    position_ = 0;
    if (info_.depth == CV_32F && largest <= 1) return 1;
    double white = 255;
    while (white < largest) white = 2 * white + 1;
    return white;
  }

  fs::path path_;
  std::vector<TiffPage> pages_;
  bool grey_;
  core::ClipInfo info_;
  std::size_t range_ = 1, position_ = 0;
  std::vector<cv::Mat> held_;  ///< decoded pages
  std::size_t held_from_ = 0;  ///< index of the first one
};

}  // namespace

std::unique_ptr<FrameDecoder> decode_tiff(const fs::path& path, bool grey, const core::Warn& warn) {
  silence_media_libraries();
  auto pages = read_tiff_pages(path);
  const int in_file = static_cast<int>(pages.size());
  std::erase_if(pages, [](const TiffPage& page) { return !page.is_picture(); });
  if (pages.empty()) throw core::IoError("cannot read " + path.string() + ": it holds no picture");
  if (warn && static_cast<int>(pages.size()) < in_file)
    warn(path.string() + ": " + std::to_string(in_file - static_cast<int>(pages.size())) +
         " of its pages are smaller copies or masks, and are passed over");
  if (pages.size() == 1 && pages.front().format != 3) return decode_images({path}, grey, warn);
  return std::make_unique<TiffClip>(path, std::move(pages), grey, warn);
}

}  // namespace emberfold::io
