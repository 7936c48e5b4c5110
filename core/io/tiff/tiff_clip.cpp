// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/media_log.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff/raw_page.hpp"
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
  /// `planes`: the pages that make each frame: one, or all of which the brightest values are taken.
  TiffClip(fs::path path, std::vector<TiffPage> pages, std::vector<std::vector<int>> planes, bool grey,
           const core::Warn& warn)
      : path_(std::move(path)), pages_(std::move(pages)), planes_(std::move(planes)), grey_(grey) {
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
    info_.frames = static_cast<std::int64_t>(planes_.size());
    info_.fps_is_known = false;
    if (info_.depth != CV_8U) info_.white = info_.depth == CV_16U ? 65535 : 1;
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  /// What the file's metadata tell.
  void set_scales(const TiffAxes& axes) {
    info_.pixel_um = axes.pixel_um;
    if (!axes.interval) return;
    info_.fps = 1 / *axes.interval;
    info_.fps_is_known = true;
  }

  cv::Mat next() override {
    if (position_ == planes_.size()) return {};
    cv::Mat frame;
    for (const int index : planes_[position_]) {
      const cv::Mat& page = held(static_cast<std::size_t>(index));
      frame = frame.empty() ? page.clone() : cv::Mat(cv::max(frame, page));
    }
    ++position_;
    return grey_ ? to_grey(frame) : frame;
  }

  bool skip() override {
    if (position_ == planes_.size()) return false;
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

  /// Returns a page, decoded with those near it that will be asked for next.
  const cv::Mat& held(std::size_t page) {
    if (const auto found = held_.find(page); found != held_.end()) return found->second;
    if (held_.size() > 2 * range_) held_.clear();
    const std::size_t count = pages_[page].raw ? 1 : pages_wanted(page);
    decode(page, count);
    return held_.at(page);
  }

  /// The number of pages from this one on that coming frames take, with small gaps. Frames of many pages
  /// share the range among these, so that all find room.
  [[nodiscard]] std::size_t pages_wanted(std::size_t page) const {
    constexpr std::size_t kGap = 16;
    const std::size_t most = std::max<std::size_t>(1, range_ / planes_[position_].size());
    std::size_t last = page;
    for (std::size_t i = position_; i < std::min(position_ + most, planes_.size()); ++i)
      for (const int plane : planes_[i]) {
        const auto at = static_cast<std::size_t>(plane);
        if (at > last && at <= last + kGap && at < page + most) last = at;
      }
    return last - page + 1;
  }

  void decode(std::size_t begin, std::size_t count) {
    const int first = pages_[begin].index, last = pages_[begin + count - 1].index;
    std::vector<cv::Mat> found;
    try {
      const SilentErrors silent;
      if (pages_[begin].raw)
        found.push_back(read_raw_page(path_, pages_[begin]));
      else
        cv::imreadmulti(path_.string(), found, first, last - first + 1,
                        cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
    } catch (const cv::Exception&) {  // the page that it stopped at is missing
    }
    for (std::size_t i = begin; i < begin + count; ++i) {
      const auto at = static_cast<std::size_t>(pages_[i].index - first);
      if (at >= found.size() || found[at].empty()) fail("page " + std::to_string(i) + " cannot be decoded");
      held_.emplace(i, checked(std::move(found[at]), i));
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
    return page;
  }

  fs::path path_;
  std::vector<TiffPage> pages_;
  std::vector<std::vector<int>> planes_;
  bool grey_;
  core::ClipInfo info_;
  std::size_t range_ = 1, position_ = 0;
  std::map<std::size_t, cv::Mat> held_;  ///< decoded pages
};

std::string many(int count, const char* what) {
  return std::to_string(count) + " " + what;
}

/// Checks what is asked for against the axes; tells where something was chosen without being asked for.
class PlaneChoice {
 public:
  PlaneChoice(const fs::path& path, TiffAxes& axes, const ReadOptions& options, const core::Warn& warn)
      : path_(path), warn_(warn) {
    const bool slice_asked = options.slice || options.brightest_slice;
    if (axes.slices_are_frames && !slice_asked) {
      std::swap(axes.frames, axes.slices);
      tell("its " + many(axes.frames, "pages") + " are slices by its head; they are read as frames");
    }
    constexpr int kMostColours = 4;  // some programs call the frames of a plain stack channels
    if (axes.frames == 1 && axes.slices == 1 && axes.channels > kMostColours && !options.channel) {
      std::swap(axes.frames, axes.channels);
      tell("its " + many(axes.frames, "pages") + " are channels by its head; they are read as frames");
    }
    if (slice_asked && axes.slices == 1) refuse("it has no slices for --slice");
    if (options.slice && *options.slice >= axes.slices)
      refuse("slice " + std::to_string(*options.slice) + " is out of range: 0 to " +
             std::to_string(axes.slices - 1));
    if (options.channel && axes.channels > 1 && *options.channel >= axes.channels)
      refuse("channel " + std::to_string(*options.channel) + " is out of range: 0 to " +
             std::to_string(axes.channels - 1));
    choose_unasked(axes, options);
    for (int t = 0; t < axes.frames; ++t) {
      planes.emplace_back();
      for (int z = first_; z < last_; ++z) planes.back().push_back(axes.plane(t, z, channel_));
    }
  }

  std::vector<std::vector<int>> planes;

 private:
  void tell(const std::string& what) const {
    if (warn_) warn_(path_.string() + ": " + what);
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw core::InputError(path_.string() + ": " + what);
  }

  void choose_unasked(const TiffAxes& axes, const ReadOptions& options) {
    if (axes.channels > 1) {
      channel_ = options.channel.value_or(0);
      if (!options.channel)
        tell("it has " + many(axes.channels, "channels") + ", of which the first is read; --channel 0 to " +
             std::to_string(axes.channels - 1) + " chooses");
    }
    if (options.brightest_slice) {
      last_ = axes.slices;
      return;
    }
    first_ = options.slice.value_or(axes.slices / 2);
    last_ = first_ + 1;
    if (!options.slice && axes.slices > 1)
      tell("it has " + many(axes.slices, "slices") + ", of which the middle one, " + std::to_string(first_) +
           ", is read; --slice chooses, or takes the brightest values of all (max)");
  }

  const fs::path& path_;
  const core::Warn& warn_;
  int channel_ = 0, first_ = 0, last_ = 1;
};

}  // namespace

std::unique_ptr<FrameDecoder> decode_tiff(const fs::path& path, const ReadOptions& options,
                                          const core::Warn& warn) {
  silence_media_libraries();
  auto pages = read_tiff_pages(path);
  const int in_file = static_cast<int>(pages.size());
  const std::string description = pages.front().description;
  std::erase_if(pages, [](const TiffPage& page) { return !page.is_picture(); });
  if (pages.empty()) throw core::IoError("cannot read " + path.string() + ": it holds no picture");
  if (warn && static_cast<int>(pages.size()) < in_file)
    warn(path.string() + ": " + std::to_string(in_file - static_cast<int>(pages.size())) +
         " of its pages are smaller copies or masks, and are passed over");
  pages.front().description = description;
  if (pages.size() == 1 && pages.front().format != 3) return decode_images({path}, options, warn);
  TiffAxes axes = read_tiff_axes(path, pages);
  if (warn)
    for (const auto& doubt : axes.doubts) warn(path.string() + ": " + doubt);
  PlaneChoice choice(path, axes, options, warn);
  auto clip =
      std::make_unique<TiffClip>(path, std::move(pages), std::move(choice.planes), options.grey, warn);
  clip->set_scales(axes);
  return clip;
}

}  // namespace emberfold::io
