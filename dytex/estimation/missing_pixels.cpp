// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/missing_pixels.hpp"

#include <algorithm>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/text/size_text.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::dytex {

namespace {

std::size_t pixel_count(const core::ClipInfo& info) {
  return static_cast<std::size_t>(std::max(info.width, 0)) *
         static_cast<std::size_t>(std::max(info.height, 0));
}

/// Calls body(pixel) for each hidden pixel of a frame.
template <class Body>
void for_hidden(const Missing& missing, std::size_t frame, const Body& body) {
  if (missing.all_seen(frame)) return;
  for (std::size_t p = 0; p < missing.pixels(); ++p)
    if (missing.hidden(p, frame)) body(p);
}

void copy_pixel(const cv::Mat& from, cv::Mat& to, std::size_t pixel) {
  const std::size_t bytes = from.elemSize();
  std::copy_n(from.data + pixel * bytes, bytes, to.data + pixel * bytes);
}

/// Adds the seen pixels of a frame to `sum` (CV_64F) and counts them.
void add_seen_pixels(const Missing& missing, std::size_t t, const cv::Mat& frame, cv::Mat& sum,
                     std::vector<std::uint32_t>& counts) {
  cv::Mat values;
  frame.convertTo(values, CV_64F);
  const auto channels = static_cast<std::size_t>(frame.channels());
  const auto* from = values.ptr<double>();
  auto* to = sum.ptr<double>();
  for (std::size_t p = 0; p < counts.size(); ++p) {
    if (missing.hidden(p, t)) continue;
    ++counts[p];
    for (std::size_t c = 0; c < channels; ++c) to[p * channels + c] += from[p * channels + c];
  }
}

}  // namespace

Missing::Missing(core::FrameSource& mask, const core::ClipInfo& clip, const core::Context& context) {
  const core::ClipInfo& info = mask.info();
  if (info.width != clip.width || info.height != clip.height)
    throw core::InputError("the mask is " + core::size_text(info.width, info.height) + ", the clip " +
                           core::size_text(clip.width, clip.height));
  pixels_ = pixel_count(clip);
  std::vector<std::vector<std::uint64_t>> rows;  // by 64 frames
  mask.rewind();
  std::size_t frames = 0;
  int group = -1;
  for (cv::Mat frame = mask.next(); !frame.empty(); frame = mask.next(), ++frames) {
    context.check();
    if (frame.cols != info.width || frame.rows != info.height)
      throw core::IoError("the mask's frame " + std::to_string(frames) + " is " +
                          core::size_text(frame.cols, frame.rows) + ", the others " +
                          core::size_text(info.width, info.height));
    const cv::Mat luma = core::luma(frame, info);
    const cv::Mat bright = luma >= 127.5F;
    if (frames % 64 == 0) rows.emplace_back(pixels_, 0);
    for (std::size_t p = 0; p < pixels_; ++p)
      if (bright.data[p] != 0) rows.back()[p] |= std::uint64_t{1} << (frames % 64);
    counts_.push_back(static_cast<std::size_t>(cv::countNonZero(bright)));
    const bool as_before = frames > 0 && cv::norm(bright, before_, cv::NORM_INF) == 0;
    if (!as_before) ++group;
    groups_.push_back(counts_.back() == pixels_ ? -1 : group);
    before_ = bright;
  }
  before_.release();
  if (frames == 0) throw core::InputError("the mask has no frames");
  const auto gone = static_cast<std::size_t>(std::count(groups_.begin(), groups_.end(), -1));
  if (gone == frames) throw core::InputError("the mask hides every pixel of every frame");
  if (gone + 1 == frames)
    throw core::InputError("the mask hides every pixel of all frames but one, at least 2 must be seen");
  words_ = rows.size();
  bits_.resize(pixels_ * words_);
  for (std::size_t w = 0; w < words_; ++w)
    for (std::size_t p = 0; p < pixels_; ++p) bits_[p * words_ + w] = rows[w][p];
  frames_ = frames;
}

void Missing::check_frames(std::size_t frames) const {
  if (frames_ > 0 && frames != frames_)
    throw core::InputError("the mask has " + std::to_string(frames_) + " frames, the clip " +
                           std::to_string(frames));
}

bool Missing::by_frames() const {
  return std::all_of(counts_.begin(), counts_.end(),
                     [&](std::size_t count) { return count == 0 || count == pixels_; });
}

FilledSource::FilledSource(core::FrameSource& source, const Missing& missing,
                           const LinearDynamicTexture& texture)
    : source_(source), missing_(missing), texture_(texture) {
  const core::ClipInfo &a = source.info(), &b = texture.info;
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw core::InputError("the texture is " + core::size_text(b.width, b.height) + " of " +
                           std::to_string(b.channels) + " channels, the clip " +
                           core::size_text(a.width, a.height) + " of " + std::to_string(a.channels));
  missing.check_frames(static_cast<std::size_t>(texture.states.cols()));
}

cv::Mat FilledSource::next() {
  cv::Mat frame = source_.next();
  if (frame.empty()) return frame;
  const std::size_t t = position_++;
  if (t >= static_cast<std::size_t>(texture_.states.cols()))
    throw core::InputError("the clip has more than the " + std::to_string(texture_.states.cols()) +
                           " frames that the texture has states of");
  if (missing_.all_seen(t)) return frame;
  cv::Mat guess;
  draw(texture_, texture_.states.col(static_cast<Eigen::Index>(t)))
      .convertTo(guess, frame.type(), source_.info().white / 255);
  if (!frame.isContinuous()) frame = frame.clone();
  for_hidden(missing_, t, [&](std::size_t p) { copy_pixel(guess, frame, p); });
  return frame;
}

void FilledSource::rewind() {
  source_.rewind();
  position_ = 0;
}

HeldSource::HeldSource(core::FrameSource& source, const Missing& missing, const core::Context& context)
    : source_(source), missing_(missing) {
  const core::ClipInfo& info = source.info();
  const std::size_t pixels = pixel_count(info), channels = static_cast<std::size_t>(info.channels);
  cv::Mat sum(info.height, info.width, CV_64FC(info.channels), cv::Scalar::all(0));
  std::vector<std::uint32_t> counts(pixels, 0);
  source.rewind();
  std::size_t frames = 0;
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    if (frame.size() != sum.size() || frame.channels() != info.channels)
      throw core::IoError("frame " + std::to_string(frames) + " is " +
                          core::size_text(frame.cols, frame.rows) + ", the clip's frames are " +
                          core::size_text(info.width, info.height));
    if (frames < missing.frames()) add_seen_pixels(missing, frames, frame, sum, counts);
    ++frames;
  }
  missing.check_frames(frames);
  std::vector<double> means(channels, 0), total(channels, 0);
  auto* values = sum.ptr<double>();
  double seen = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    seen += counts[p];
    for (std::size_t c = 0; c < channels; ++c) {
      total[c] += values[p * channels + c];
      values[p * channels + c] /= std::max(counts[p], 1U);
    }
  }
  never_seen_ = static_cast<std::size_t>(std::count(counts.begin(), counts.end(), 0U));
  for (std::size_t p = 0; p < pixels && never_seen_ > 0; ++p)
    for (std::size_t c = 0; c < channels && counts[p] == 0; ++c)
      values[p * channels + c] = total[c] / std::max(seen, 1.0);
  sum.convertTo(mean_, info.depth);
  rewind();
}

cv::Mat HeldSource::next() {
  cv::Mat frame = source_.next();
  if (frame.empty()) return frame;
  if (!frame.isContinuous()) frame = frame.clone();
  const std::size_t t = position_++;
  if (t < missing_.frames()) for_hidden(missing_, t, [&](std::size_t p) { copy_pixel(held_, frame, p); });
  frame.copyTo(held_);
  return frame;
}

void HeldSource::rewind() {
  source_.rewind();
  position_ = 0;
  held_ = mean_.clone();
}

}  // namespace emberfold::dytex
