// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/transformed_clip.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/masked_source.hpp"
#include "core/error.hpp"
#include "core/io/reading/levels.hpp"
#include "core/io/reading/mask_clip.hpp"
#include "core/io/reading/missing_pixels.hpp"
#include "core/io/reading/stabilizer.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace {

constexpr std::int64_t max_pixels = std::int64_t{1} << 28;

class TransformedClip final : public core::FrameSource, public core::ClipKnowledge {
 public:
  TransformedClip(std::string name, std::unique_ptr<FrameDecoder> decoder, const ReadOptions& options,
                  const core::Warn& warn)
      : name_(std::move(name)),
        decoder_(std::move(decoder)),
        options_(options),
        warn_(warn),
        levels_(find_levels(*decoder_, options.levels, name_, warn)),
        info_(decoder_->info()) {
    take_levels();
    take_scales();
    stored_ = {info_.width, info_.height};
    if (!options_.mask.empty()) masks_.emplace(options_, stored_, warn_);
    take_size();
    start();
    cv::Mat first = decoder_->next();
    if (const auto words = outside_levels(first, options_.levels); warn_ && !words.empty())
      warn_(name_ + ": " + words);
    pending_ = transform(std::move(first));
    pending_mask_ = mask_;
    if (pending_.empty()) refuse_range();
    ++position_;
    count();
    if (!info_.fps_is_known && info_.frames.value_or(2) > 1 && warn_)
      warn_(name_ + ": its frame rate is not known; taken as 25 a second, unless --fps tells it");
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    if (!pending_.empty()) {
      taken_ = 1;
      mask_ = pending_mask_;
      return std::exchange(pending_, {});
    }
    const std::int64_t at = options_.first + taken_ * options_.every;
    if (options_.last && at >= *options_.last) return {};
    cv::Mat frame;
    if (skip_to(at)) frame = transform(decoder_->next());
    if (frame.empty()) {
      end();
    } else {
      ++taken_;
      ++position_;
    }
    return frame;
  }

  [[nodiscard]] cv::Mat mask() const override { return mask_; }
  [[nodiscard]] std::vector<core::CameraMotion> drift() const override { return drift_; }

  void rewind() override {
    if (taken_ == 0) return;
    pending_.release();
    taken_ = 0;
    decoder_->rewind();
    start();
  }

 private:
  void start() {
    position_ = 0;
    looked_at_ = 0;
    if (masks_) masks_->rewind();
    if (!skip_to(options_.first)) refuse_range();
  }

  /// Skips to the stored frame `at`; false where the clip ends before it.
  bool skip_to(std::int64_t at) {
    for (; position_ < at; ++position_)
      if (!decoder_->skip()) return false;
    return true;
  }

  [[noreturn]] void refuse(const std::string& what) const { throw core::InputError(what); }

  [[noreturn]] void refuse_range() const {
    const auto frames = decoder_->info().frames;
    refuse("the range begins at frame " + std::to_string(options_.first) + ", but " + name_ + " has " +
           (frames ? std::to_string(*frames) : std::string("fewer")) + " frames (the first is 0)");
  }

  void take_levels() { info_.white = info_.depth == CV_8U ? 255 : levels_.white - levels_.black; }

  /// Sets rate and pixel size, from the file or as given.
  void take_scales() {
    if (options_.fps) info_.fps = *options_.fps, info_.fps_is_known = true, info_.times.clear();
    take_origin();
    info_.fps /= options_.every;
    take_times();
    if (options_.pixel_size) info_.pixel_um = options_.pixel_size;
    if (info_.pixel_um) info_.pixel_um = *info_.pixel_um / options_.scale;
  }

  /// Sets what positions and times of a part count from, while the rate is still that of the source.
  void take_origin() {
    if (!options_.region && options_.first == 0) return;
    info_.origin.counted_from = options_.counts_from_part ? "part" : "source";
    if (options_.counts_from_part) return;
    info_.origin.seconds = static_cast<double>(options_.first) / info_.fps;
    if (const auto& region = options_.region)
      info_.origin.x = region->x * options_.scale, info_.origin.y = region->y * options_.scale;
  }

  /// Keeps the times of the frames that are read; the rate is their mean.
  void take_times() {
    const std::vector<double> stored = std::exchange(info_.times, {});
    const auto end = std::min(options_.last.value_or(std::ssize(stored)), std::ssize(stored));
    for (std::int64_t i = options_.first; i < end; i += options_.every)
      info_.times.push_back(stored[static_cast<std::size_t>(i)]);
    if (info_.times.empty()) return;
    const double first = info_.times.front(), whole = info_.times.back() - first;
    if (whole > 0) info_.fps = static_cast<double>(info_.times.size() - 1) / whole;
    info_.origin.seconds = options_.counts_from_part ? 0 : first;
    if (options_.counts_from_part)
      for (double& time : info_.times) time -= first;
  }

  void take_size() {
    if (options_.channel && info_.channels == 3 && *options_.channel > 2)
      refuse("channel " + std::to_string(*options_.channel) +
             " is out of range: 0 (red), 1 (green) or 2 (blue)");
    if (options_.grey || options_.channel) info_.channels = 1;
    if (const auto& region = options_.region) {
      if (region->x > info_.width - region->width || region->y > info_.height - region->height)
        refuse("roi " + std::to_string(region->x) + "," + std::to_string(region->y) + "," +
               std::to_string(region->width) + "," + std::to_string(region->height) +
               " is out of range: the frames of " + name_ + " have " +
               core::size_text(info_.width, info_.height) + " pixels");
      info_.width = region->width, info_.height = region->height;
    }
    const auto scaled = [&](int length) { return std::max(1.0, std::round(length * options_.scale)); };
    const double width = scaled(info_.width), height = scaled(info_.height);
    if (width * height > static_cast<double>(max_pixels))
      refuse("scale " + core::number_text(options_.scale) + " would make frames of " +
             core::number_text(width) + "x" + core::number_text(height) +
             " pixels; at most 2^28 pixels are allowed");
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
  }

  void count() {
    const auto frames = decoder_->info().frames;
    info_.frames.reset();
    if (!frames) return;
    const std::int64_t range = std::min(options_.last.value_or(*frames), *frames) - options_.first;
    info_.frames = std::max<std::int64_t>(0, (range + options_.every - 1) / options_.every);
  }

  void end() {
    count();
    const auto frames = decoder_->info().frames;
    if (options_.last && frames && *frames < *options_.last && !std::exchange(warned_, true) && warn_)
      warn_("the range ends at frame " + std::to_string(*options_.last) + ", but " + name_ + " has " +
            std::to_string(*frames) + " frames");
  }

  [[nodiscard]] cv::Mat transform(cv::Mat frame) {
    if (frame.empty()) return frame;
    const cv::Mat finite = levels_.misses ? finite_part(frame) : cv::Mat();
    frame = apply_levels(frame, levels_);
    mask_ = masks_ ? masks_->next() : finite;
    if (masks_ && !finite.empty()) mask_ = cv::Mat(mask_ & finite);
    if (options_.stabilize != Stabilize::none) frame = stabilized(frame);
    if (const auto& region = options_.region) {
      const cv::Rect part(region->x, region->y, region->width, region->height);
      frame = frame(part).clone();
      if (!mask_.empty()) mask_ = mask_(part).clone();
    }
    if (options_.channel && frame.channels() == 3) {
      cv::Mat one;
      cv::extractChannel(frame, one, 2 - *options_.channel);  // blue comes first
      frame = one;
    }
    if (options_.grey) frame = to_grey(frame);
    if (!mask_.empty()) mask_ = scaled_mask();
    return scaled(frame);
  }

  /// Fills non-finite values; returns where the frame was finite, everywhere if it was whole.
  static cv::Mat finite_part(cv::Mat& frame) {
    const cv::Mat finite = fill_missing(frame);
    return finite.empty() ? cv::Mat(frame.size(), CV_8U, cv::Scalar(255)) : finite;
  }

  /// Removes the motion of the picture. Pixels from outside the frame then do not count.
  cv::Mat stabilized(const cv::Mat& frame) {
    const auto t = static_cast<std::size_t>(looked_at_++);
    if (t == drift_.size()) drift_.push_back(stabilizer_.follow(core::luma(frame, info_), mask_));
    const cv::Mat matrix = warp_matrix(drift_[t], stored_);
    const cv::Mat counts = mask_.empty() ? cv::Mat(stored_, CV_8U, cv::Scalar(255)) : mask_;
    cv::Mat placed, seen;
    cv::warpAffine(frame, placed, matrix, stored_, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    cv::warpAffine(counts, seen, matrix, stored_, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    mask_ = seen > 127;
    // Cubic interpolation overshoots; floats below black may have been there before.
    if (placed.depth() != CV_32F) cv::min(placed, cv::Scalar::all(info_.white), placed);
    return placed;
  }

  [[nodiscard]] cv::Mat scaled_mask() const {
    const cv::Size size(info_.width, info_.height);
    if (mask_.size() == size) return mask_;
    cv::Mat resized;
    cv::resize(mask_, resized, size, 0, 0, size.width < mask_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
    return resized > 127;
  }

  [[nodiscard]] cv::Mat scaled(const cv::Mat& frame) const {
    const cv::Size size(info_.width, info_.height);
    if (frame.size() == size) return frame;
    const bool grows = size.width > frame.cols || size.height > frame.rows;
    cv::Mat resized;
    cv::resize(frame, resized, size, 0, 0, grows ? cv::INTER_CUBIC : cv::INTER_AREA);
    if (grows) cv::min(resized, cv::Scalar::all(info_.white), resized);  // bicubic overshoots
    return resized;
  }

  std::string name_;
  std::unique_ptr<FrameDecoder> decoder_;
  ReadOptions options_;
  core::Warn warn_;
  LevelRange levels_;
  core::ClipInfo info_;
  cv::Mat pending_;            ///< the first frame, read to check that the range holds one
  std::int64_t taken_ = 0;     ///< frames returned
  std::int64_t position_ = 0;  ///< stored frames read or skipped
  bool warned_ = false;

  cv::Size stored_;
  std::optional<MaskClip> masks_;
  Stabilizer stabilizer_{options_.stabilize};
  std::vector<core::CameraMotion> drift_;  ///< of every frame so far: found once, however often it is read
  std::int64_t looked_at_ = 0;             ///< frames since the first that were transformed
  cv::Mat mask_, pending_mask_;
};

}  // namespace

std::unique_ptr<core::FrameSource> transform_clip(std::string name, std::unique_ptr<FrameDecoder> decoder,
                                                  const ReadOptions& options, const core::Warn& warn) {
  return std::make_unique<TransformedClip>(std::move(name), std::move(decoder), options, warn);
}

}  // namespace emberfold::io
