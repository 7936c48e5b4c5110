// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff/page_reader.hpp"
#include "core/io/tiff/samples.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

class TiffClip final : public FrameDecoder {
 public:
  /// `planes`: the pages that make each frame: one, or several whose brightest values are taken.
  TiffClip(const fs::path& path, std::vector<TiffPage> pages, std::vector<std::vector<int>> planes, bool grey)
      : path_(path), reader_(path), pages_(std::move(pages)), planes_(std::move(planes)), grey_(grey) {
    check_pages();
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

  /// Takes size and rate from the file's metadata.
  void set_scales(const TiffAxes& axes) {
    info_.pixel_um = axes.pixel_um;
    if (!axes.interval) return;
    info_.fps = 1 / *axes.interval;
    info_.fps_is_known = true;
    info_.times = axes.times;
  }

  cv::Mat next() override {
    if (position_ == planes_.size()) return {};
    cv::Mat frame;
    for (const int index : planes_[position_]) {
      const cv::Mat page = reader_.read(pages_[static_cast<std::size_t>(index)]);
      frame = frame.empty() ? page : cv::Mat(cv::max(frame, page));
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
  void check_pages() const {
    const TiffPage& first = pages_.front();
    const auto text = [](const TiffPage& page) {
      return std::to_string(page.width) + "x" + std::to_string(page.height) + " pixels of " +
             std::to_string(page.samples) + " x " + std::to_string(page.bits) + " bits";
    };
    const bool is_colour = meaning_of(first).is_colour;
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      const TiffPage& page = pages_[i];
      const bool is_turned = (page.orientation > 4) != (first.orientation > 4);
      if (page.width != first.width || page.height != first.height || page.bits != first.bits ||
          page.samples != first.samples || page.format != first.format || is_turned ||
          meaning_of(page).is_colour != is_colour)
        throw core::IoError("cannot read " + path_.string() + ": page " + std::to_string(i) + " is " +
                            text(page) + ", the first " + text(first) + "; all need to be of one kind");
    }
  }

  fs::path path_;
  PageReader reader_;
  std::vector<TiffPage> pages_;
  std::vector<std::vector<int>> planes_;
  bool grey_;
  core::ClipInfo info_;
  std::size_t position_ = 0;
};

std::string many(int count, const char* what) {
  return std::to_string(count) + " " + what;
}

/// Checks the requested channel and slice against the axes; warns of those chosen by default.
class PlaneChoice {
 public:
  /// `samples`: of a pixel, where they are separate channels.
  PlaneChoice(const fs::path& path, TiffAxes& axes, int samples, const ReadOptions& options,
              const core::Warn& warn)
      : path_(path), warn_(warn), channels_(axes.channels * samples) {
    const bool slice_asked = options.slice || options.brightest_slice;
    if (axes.slices_are_frames && !slice_asked) {
      std::swap(axes.frames, axes.slices);
      tell("its " + many(axes.frames, "pages") + " are slices by its head; they are read as frames");
    }
    constexpr int kMostColours = 4;  // some programs call the frames of a plain stack channels
    if (axes.frames == 1 && axes.slices == 1 && axes.channels > kMostColours && !options.channel) {
      std::swap(axes.frames, axes.channels);
      channels_ = samples;
      tell("its " + many(axes.frames, "pages") + " are channels by its head; they are read as frames");
    }
    if (slice_asked && axes.slices == 1) refuse("it has no slices for --slice");
    if (options.slice && *options.slice >= axes.slices)
      refuse("slice " + std::to_string(*options.slice) + " is out of range: 0 to " +
             std::to_string(axes.slices - 1));
    if (options.channel && channels_ > 1 && *options.channel >= channels_)
      refuse("channel " + std::to_string(*options.channel) + " is out of range: 0 to " +
             std::to_string(channels_ - 1));
    choose_unasked(axes, options);
    sample = samples > 1 ? channel_ % samples : options.channel;
    for (int t = 0; t < axes.frames; ++t) {
      planes.emplace_back();
      for (int z = first_; z < last_; ++z) planes.back().push_back(axes.plane(t, z, channel_ / samples));
    }
  }

  std::vector<std::vector<int>> planes;
  std::optional<int> sample;  ///< read, where pixels have several

 private:
  void tell(const std::string& what) const {
    if (warn_) warn_(path_.string() + ": " + what);
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw core::InputError(path_.string() + ": " + what);
  }

  void choose_unasked(const TiffAxes& axes, const ReadOptions& options) {
    if (channels_ > 1) {
      channel_ = options.channel.value_or(0);
      if (!options.channel)
        tell("it has " + many(channels_, "channels") + ", of which the first is read; --channel 0 to " +
             std::to_string(channels_ - 1) + " chooses");
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
  int channels_, channel_ = 0, first_ = 0, last_ = 1;
};

/// Inverts values about the largest number of the bits that the planes use: a camera of 12 bits stays one.
void choose_white(const fs::path& path, std::vector<TiffPage>& pages,
                  const std::vector<std::vector<int>>& planes) {
  const SampleMeaning meaning = meaning_of(pages.front());
  if (!meaning.is_inverted || meaning.depth == CV_8U) return;
  PageReader reader(path);
  double largest = 0;
  for (const auto& frame : planes)
    for (const int plane : frame) {
      const TiffPage& page = pages[static_cast<std::size_t>(plane)];
      double least = 0;
      cv::minMaxLoc(reader.read(page), &least);
      largest = std::max(largest, white_of(page, meaning) - least);
    }
  double white = 255;
  while (white < largest) white = 2 * white + 1;
  for (TiffPage& page : pages) page.white = meaning.depth == CV_32F && largest <= 1 ? 1 : white;
}

}  // namespace

std::unique_ptr<FrameDecoder> decode_tiff(const fs::path& path, const ReadOptions& options,
                                          const core::Warn& warn) {
  auto pages = read_picture_pages(path, warn);
  TiffAxes axes = read_tiff_axes(path, pages);
  if (warn)
    for (const auto& doubt : axes.doubts) warn(path.string() + ": " + doubt);
  PlaneChoice choice(path, axes, meaning_of(pages.front()).channels, options, warn);
  for (TiffPage& page : pages) choose_sample(path, page, choice.sample, {});
  choose_white(path, pages, choice.planes);
  auto clip = std::make_unique<TiffClip>(path, std::move(pages), std::move(choice.planes), options.grey);
  clip->set_scales(axes);
  return clip;
}

}  // namespace emberfold::io
