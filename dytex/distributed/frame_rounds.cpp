// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/frame_rounds.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "core/clip/skipping.hpp"
#include "core/error.hpp"
#include "dytex/distributed/together.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kCopies = 4;  // of a round's frames: decoded, to be sent, received, and in transit

std::string kind_text(int width, int height, int type) {
  return std::to_string(width) + " × " + std::to_string(height) + " of OpenCV's type " + std::to_string(type);
}

}  // namespace

FrameRounds::FrameRounds(Communicator& ranks, const Stripes& stripes, const SharedClip& clip,
                         std::size_t memory)
    : ranks_(ranks),
      stripes_(stripes),
      clip_(clip),
      value_bytes_(CV_ELEM_SIZE1(clip_.info.depth)),
      segment_(std::max<std::size_t>(memory / kCopies / (stripes.values() * value_bytes_), 1)) {}

std::size_t FrameRounds::asked_from(std::size_t first, std::size_t most) const {
  const std::size_t asked = std::min(most, segment_ * static_cast<std::size_t>(clip_.readers));
  if (clip_.readers == 1) return asked;
  const auto frames = static_cast<std::size_t>(*clip_.info.frames);
  return first < frames ? std::min(asked, frames - first) : 0;
}

std::vector<cv::Mat> FrameRounds::read(std::size_t first, std::size_t last, const core::Context& context) {
  if (first == last) return {};
  if (!std::exchange(began_, true)) clip_.source->rewind();
  core::skip_frames(*clip_.source, static_cast<std::int64_t>(first - position_));
  position_ = first;
  std::vector<cv::Mat> frames;
  const core::ClipInfo& info = clip_.info;
  const int type = CV_MAKETYPE(info.depth, info.channels);
  while (position_ < last) {
    context.check();
    cv::Mat frame = clip_.source->next();
    if (frame.empty()) break;
    if (frame.cols != info.width || frame.rows != info.height || frame.type() != type)
      throw core::IoError("frame " + std::to_string(position_) + " is " +
                          kind_text(frame.cols, frame.rows, frame.type()) + ", the clip's frames are " +
                          kind_text(info.width, info.height, type));
    frames.push_back(frame.isContinuous() ? frame : frame.clone());
    ++position_, ++decoded_;
  }
  if (position_ < last && clip_.readers > 1)
    throw core::IoError("the clip ends with frame " + std::to_string(position_) + ", told were " +
                        std::to_string(*info.frames) + " frames");
  return frames;
}

std::vector<std::byte> FrameRounds::packed(const std::vector<cv::Mat>& frames) const {
  std::vector<std::byte> result(frames.size() * stripes_.values() * value_bytes_);
  std::byte* to = result.data();
  for (std::size_t stripe = 0; stripe < stripes_.count(); ++stripe) {
    const std::size_t begin = stripes_.begin(stripe) * value_bytes_,
                      size = stripes_.size(stripe) * value_bytes_;
    for (const cv::Mat& frame : frames) {
      std::memcpy(to, frame.data + begin, size);
      to += size;
    }
  }
  return result;
}

std::size_t FrameRounds::next(std::size_t first, std::size_t most, const PutValues& put,
                              const core::Context& context) {
  const auto count = static_cast<std::size_t>(ranks_.ranks()), me = static_cast<std::size_t>(ranks_.rank()),
             readers = static_cast<std::size_t>(clip_.readers);
  const std::size_t asked = asked_from(first, most);
  const auto begin_of = [&](std::size_t rank) { return first + asked * std::min(rank, readers) / readers; };
  std::vector<std::byte> sent;
  const auto read_frames = tell_together(ranks_, [&]() -> std::int64_t {
    context.check();
    if (me >= readers) return 0;
    const std::vector<cv::Mat> frames = read(begin_of(me), begin_of(me + 1), context);
    sent = packed(frames);
    return static_cast<std::int64_t>(frames.size());
  });
  const auto values_of = [&](std::size_t rank) {  // begins at that of its first stripe
    return stripes_.begin(stripes_.first_of(static_cast<int>(rank)));
  };
  const auto frames_of = [&](std::size_t rank) { return static_cast<std::size_t>(read_frames[rank]); };
  const std::size_t own = (values_of(me + 1) - values_of(me)) * value_bytes_;
  std::vector<std::span<const std::byte>> to;
  std::vector<std::span<std::byte>> from;
  std::size_t all = 0;
  for (std::size_t r = 0; r < count; ++r) all += frames_of(r);
  std::vector<std::byte> received;
  together(ranks_, [&] { received.resize(all * own); });
  for (std::size_t r = 0, at = 0; r < count; ++r) {
    const std::size_t frame_bytes = frames_of(me) * value_bytes_;
    to.push_back(
        std::span(sent).subspan(values_of(r) * frame_bytes, (values_of(r + 1) - values_of(r)) * frame_bytes));
    from.push_back(std::span(received).subspan(at, frames_of(r) * own));
    at += frames_of(r) * own;
  }
  ranks_.exchange(to, from);
  together(ranks_, [&] {
    for (std::size_t r = 0; r < count; ++r) {
      if (frames_of(r) == 0) continue;
      const std::byte* at = from[r].data();
      for (auto s = stripes_.first_of(ranks_.rank()); s < stripes_.first_of(ranks_.rank() + 1); ++s) {
        const std::size_t size = stripes_.size(s) * value_bytes_ * frames_of(r);
        put(s, begin_of(r), {at, size});
        at += size;
      }
    }
  });
  return all;
}

}  // namespace emberfold::dytex
