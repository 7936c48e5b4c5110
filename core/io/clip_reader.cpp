// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t max_pixels = std::int64_t{1} << 28;

std::string value_text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Applies range, grey and scale to a decoded clip.
class TransformedClip final : public core::FrameSource {
 public:
  TransformedClip(std::string name, std::unique_ptr<FrameDecoder> decoder, const ReadOptions& options,
                  const core::Warn& warn)
      : name_(std::move(name)),
        decoder_(std::move(decoder)),
        options_(options),
        warn_(warn),
        info_(decoder_->info()) {
    const auto scaled = [&](int length) { return std::max(1.0, std::round(length * options_.scale)); };
    const double width = scaled(info_.width), height = scaled(info_.height);
    if (width * height > static_cast<double>(max_pixels))
      throw core::InputError("scale " + value_text(options_.scale) + " would make frames of " +
                             value_text(width) + "x" + value_text(height) +
                             " pixels; at most 2^28 pixels are allowed");
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
    if (options_.grey) info_.channels = 1;
    start();
    pending_ = transform(decoder_->next());
    if (pending_.empty()) refuse_range();
    count();
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    if (!pending_.empty()) {
      position_ = 1;
      return std::exchange(pending_, {});
    }
    if (options_.last && options_.first + position_ >= *options_.last) return {};
    cv::Mat frame = transform(decoder_->next());
    if (frame.empty())
      end();
    else
      ++position_;
    return frame;
  }

  void rewind() override {
    if (position_ == 0) return;
    pending_.release();
    position_ = 0;
    decoder_->rewind();
    start();
  }

 private:
  void start() {
    for (std::int64_t i = 0; i < options_.first; ++i)
      if (!decoder_->skip()) refuse_range();
  }

  [[noreturn]] void refuse_range() const {
    const auto frames = decoder_->info().frames;
    throw core::InputError("the range begins at frame " + std::to_string(options_.first) + ", but " + name_ +
                           " has " + (frames ? std::to_string(*frames) : std::string("fewer")) +
                           " frames (the first is 0)");
  }

  void count() {
    const auto frames = decoder_->info().frames;
    info_.frames.reset();
    if (frames)
      info_.frames =
          std::max<std::int64_t>(0, std::min(options_.last.value_or(*frames), *frames) - options_.first);
  }

  void end() {
    count();
    if (options_.last && !std::exchange(warned_, true) && warn_)
      warn_("the range ends at frame " + std::to_string(*options_.last) + ", but " + name_ + " has " +
            std::to_string(options_.first + position_) + " frames");
  }

  [[nodiscard]] cv::Mat transform(cv::Mat frame) const {
    if (frame.empty()) return frame;
    if (options_.grey) frame = to_grey(frame);
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
  core::ClipInfo info_;
  cv::Mat pending_;  ///< the first frame, read to see that the range holds one
  std::int64_t position_ = 0;
  bool warned_ = false;
};

std::unique_ptr<FrameDecoder> open_decoder(const std::string& name, const ReadOptions& options,
                                           const core::Warn& warn) {
  const fs::path path(name);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status))
    if (const auto format = model_format(path))
      throw core::IoError(name + " is no clip but " + about_model(*format));
  if (fs::is_directory(status)) return decode_images(list_images(path), options.grey, warn);
  if (!fs::exists(status)) {
    if (is_pattern(path)) return decode_images(match_images(path), options.grey, warn);
    throw core::IoError(name.empty() ? "the clip's name is empty"
                                     : "cannot read " + name + ": " +
                                           (error && error != std::errc::no_such_file_or_directory
                                                ? error.message()
                                                : "there is no such file or folder"));
  }
  if (is_tiff(path)) return decode_tiff(path, options.grey, warn);
  if (is_image_name(path)) return decode_images({path}, options.grey, warn);
  return decode_video(path, warn);
}

}  // namespace

void ReadOptions::validate() const {
  if (first < 0)
    throw core::InputError("first frame " + std::to_string(first) + " is out of range: at least 0");
  if (last && *last <= first)
    throw core::InputError("the range " + std::to_string(first) + ":" + std::to_string(*last) +
                           " holds no frame; its end must lie behind its beginning");
  if (!(scale > 0 && scale <= 16))
    throw core::InputError("scale " + value_text(scale) + " is out of range: above 0, at most 16");
}

std::pair<std::int64_t, std::optional<std::int64_t>> parse_range(const std::string& text) {
  const auto refuse = [&]() -> std::int64_t {
    throw core::InputError(
        "\"" + text + "\" is no range of frames; give FIRST:END, FIRST: or :END (from 0, END not included)");
  };
  const auto number = [&](const char* begin, const char* end) {
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    return error != std::errc() || stop != end || value < 0 ? refuse() : value;
  };
  const auto colon = text.find(':');
  if (colon == std::string::npos || text.size() == 1) refuse();
  const char* const middle = text.data() + colon;
  const char* const end = text.data() + text.size();
  ReadOptions range;
  if (colon > 0) range.first = number(text.data(), middle);
  if (middle + 1 < end) range.last = number(middle + 1, end);
  range.validate();
  return {range.first, range.last};
}

std::unique_ptr<core::FrameSource> open_video(const std::string& name, const ReadOptions& options,
                                              const core::Warn& warn) {
  options.validate();
  return std::make_unique<TransformedClip>(name, open_decoder(name, options, warn), options, warn);
}

std::unique_ptr<core::FrameSource> open_clip(core::Clip clip, const std::string& name,
                                             const ReadOptions& options, const core::Warn& warn) {
  options.validate();
  return std::make_unique<TransformedClip>(name, decode_clip(std::move(clip)), options, warn);
}

}  // namespace emberfold::io
