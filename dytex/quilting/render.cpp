// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kMostTime = 1e6;  // frames a frame, and frames: sizes of rates and offsets

}  // namespace

void TimeControl::validate(cv::Size size) const {
  for (const auto& [name, field] : {std::pair("rate", &rate), std::pair("offset", &offset)}) {
    if (field->empty()) continue;
    const std::string what = std::string("TimeControl.") + name;
    if (field->size() != size)
      throw core::InputError(what + " has " + core::size_text(field->size()) + " pixels, the output " +
                             core::size_text(size));
    if (field->type() != CV_32F) throw core::InputError(what + " is not of 32-bit floats");
    cv::Point where;
    if (!cv::checkRange(*field, true, &where, -kMostTime, kMostTime)) {
      const float value = field->at<float>(where);
      throw core::InputError(what + " is " + (std::isnan(value) ? "not a number" : std::to_string(value)) +
                             " at " + std::to_string(where.x) + "," + std::to_string(where.y) +
                             "; allowed is -1000000 to 1000000");
    }
  }
}

FrameTime frame_time(double time, int frames, ClipEnds ends) {
  const int last = frames - 1;
  if (last == 0) return {};
  const double period = ends == ClipEnds::loop ? frames : 2.0 * last;
  if (ends == ClipEnds::clamp)
    time = std::clamp(time, 0.0, static_cast<double>(last));
  else
    time -= period * std::floor(time / period);
  if (ends == ClipEnds::ping_pong && time > last) time = period - time;
  const int before = std::min(static_cast<int>(time), ends == ClipEnds::loop ? frames - 1 : last);
  const double weight = std::clamp(time - before, 0.0, 1.0);
  if (weight == 0) return {before, before, 0};
  return {before, before == last ? (ends == ClipEnds::loop ? 0 : last) : before + 1, weight};
}

cv::Mat time_jitter(cv::Size size, cv::Size spacing, double frames, std::uint64_t seed) {
  const int columns = size.width / spacing.width + 4, rows = size.height / spacing.height + 4;
  cv::Mat grid(rows, columns, CV_64F);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      grid.at<double>(j, i) =
          core::Rng(seed, {0x6a69u, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)})
              .uniform(-frames, frames);
  // Uniform cubic B-splines stay between the values of the grid.
  const auto weights = [](double u) {
    const double v = 1 - u;
    return std::array{v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
                      u * u * u / 6};
  };
  cv::Mat field(size, CV_32F);
  for (int y = 0; y < size.height; ++y) {
    const auto down = weights(static_cast<double>(y % spacing.height) / spacing.height);
    for (int x = 0; x < size.width; ++x) {
      const auto across = weights(static_cast<double>(x % spacing.width) / spacing.width);
      double value = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
          value += down[static_cast<std::size_t>(j)] * across[static_cast<std::size_t>(i)] *
                   grid.at<double>(y / spacing.height + j, x / spacing.width + i);
      field.at<float>(y, x) = static_cast<float>(value);
    }
  }
  return field;
}

namespace {

template <class T>
T mixed(T before, T after, double weight) {
  const double value = (1 - weight) * static_cast<double>(before) + weight * static_cast<double>(after);
  if constexpr (std::is_floating_point_v<T>)
    return static_cast<T>(value);
  else
    return static_cast<T>(std::lround(value));
}

double time_of(const TimeControl& control, int x, int y, std::int64_t t) {
  const double rate = control.rate.empty() ? 1.0 : static_cast<double>(control.rate.at<float>(y, x));
  const double offset = control.offset.empty() ? 0.0 : static_cast<double>(control.offset.at<float>(y, x));
  return static_cast<double>(t) * rate - offset;
}

/// One row of some output frames; `value(pixel, frame)` points at a source pixel's channels.
template <class T, class Value>
void render_row(const QuiltMap& map, const TimeControl& control, int frames, std::int64_t first, int y,
                std::vector<cv::Mat>& out, const Value& value) {
  const int channels = out.front().channels();
  std::vector<FrameTime> moments(out.size());
  const auto set_moments = [&](int x) {
    for (std::size_t i = 0; i < out.size(); ++i)
      moments[i] =
          frame_time(time_of(control, x, y, first + static_cast<std::int64_t>(i)), frames, control.ends);
  };
  std::vector<T*> rows;
  for (auto& frame : out) rows.push_back(frame.ptr<T>(y));
  for (int x = 0; x < map.size.width; ++x) {
    if (x == 0 || !control.plain()) set_moments(x);
    const std::size_t pixel = map.index(x, y);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const FrameTime& moment = moments[i];
      const T* before = value(map.at_frame(pixel, moment.before), moment.before);
      T* const to = rows[i] + static_cast<std::ptrdiff_t>(x) * channels;
      if (moment.weight == 0) {
        for (int c = 0; c < channels; ++c) to[c] = before[c];
        continue;
      }
      const T* after = value(map.at_frame(pixel, moment.after), moment.after);
      for (int c = 0; c < channels; ++c) to[c] = mixed(before[c], after[c], moment.weight);
    }
  }
}

template <class Body>
void with_depth(int depth, const Body& body) {
  if (depth == CV_8U) body(std::uint8_t{});
  if (depth == CV_16U) body(std::uint16_t{});
  if (depth == CV_32F) body(float{});
}

}  // namespace

std::vector<cv::Mat> render_quilt(const QuiltMap& map, std::span<const Trajectories* const> sources,
                                  const TimeControl& control, std::int64_t first, int count) {
  const auto& info = sources.front()->info();
  std::vector<cv::Mat> out;
  for (int i = 0; i < count; ++i) out.emplace_back(map.size, CV_MAKETYPE(info.depth, info.channels));
  if (out.empty()) return out;
  with_depth(info.depth, [&]<class T>(T) {
    const auto value = [&](const SourcePixel& from, int frame) {
      const Trajectories& source = *sources[static_cast<std::size_t>(from.source)];
      const int length = source.chunk_frames();
      const auto pixel = static_cast<std::size_t>(from.y) * static_cast<std::size_t>(source.info().width) +
                         static_cast<std::size_t>(from.x);
      return reinterpret_cast<const T*>(source.chunk(frame / length)) + pixel * source.course() +
             static_cast<std::size_t>(frame % length * info.channels);
    };
    core::parallel_for(static_cast<std::size_t>(map.size.height), {}, [&](std::size_t y) {
      render_row<T>(map, control, sources.front()->frames(), first, static_cast<int>(y), out, value);
    });
  });
  return out;
}

namespace {

struct Times {
  double first = 0, last = 0;
};

// The earliest and latest time that an output frame may need.
Times times_of(const TimeControl& control, std::int64_t t) {
  double slow = 1, fast = 1, early = 0, late = 0;
  if (!control.rate.empty()) cv::minMaxLoc(control.rate, &slow, &fast);
  if (!control.offset.empty()) cv::minMaxLoc(control.offset, &early, &late);
  const auto time = static_cast<double>(t);
  return {time * slow - late, time * fast - early};
}

}  // namespace

std::optional<std::int64_t> streamable(const TimeControl& control, std::int64_t frames) {
  double slow = 1;
  if (!control.rate.empty()) cv::minMaxLoc(control.rate, &slow);
  if (slow < 0 || (control.ends != ClipEnds::clamp && !control.plain())) return std::nullopt;
  const Times end = times_of(control, frames - 1), begin = times_of(control, 0);
  return static_cast<std::int64_t>(std::ceil(std::max(end.last - end.first, begin.last - begin.first))) + 3;
}

QuiltStream::QuiltStream(const QuiltMap& map, std::vector<core::FrameSource*> sources,
                         const TimeControl& control)
    : map_(map), sources_(std::move(sources)), control_(control), rings_(sources_.size()) {
  control.validate(map.size);
  if (!streamable(control, 1)) throw core::InputError("these times cannot be streamed");
  const auto& first = sources_.front()->info();
  for (auto* source : sources_) {
    if (source->info().depth != first.depth || source->info().channels != first.channels)
      throw core::InputError("the sources of a quilt differ in depth or channels");
    source->rewind();
  }
}

void QuiltStream::advance(Ring& ring, core::FrameSource& source, std::int64_t from, std::int64_t to) {
  const auto next = [&] { return ring.first + static_cast<std::int64_t>(ring.frames.size()); };
  while (!ring.count && next() <= to) {
    cv::Mat frame = source.next();
    if (frame.empty()) {
      ring.count = next();
      break;
    }
    ring.frames.push_back(std::move(frame));
    if (next() > from + 1 && ring.first < from && ring.frames.size() > 1)
      ring.frames.pop_front(), ++ring.first;
  }
  if (ring.frames.empty()) throw core::InputError("a time-lapse needs at least one frame");
  while (ring.first < from && ring.frames.size() > 1) ring.frames.pop_front(), ++ring.first;
}

cv::Mat QuiltStream::next() {
  const Times times = times_of(control_, frame_);
  const auto from = static_cast<std::int64_t>(std::floor(std::max(0.0, times.first)));
  const auto to = static_cast<std::int64_t>(std::ceil(std::max(0.0, times.last))) + 1;
  std::int64_t frames = to + 1;
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    advance(rings_[s], *sources_[s], from, to);
    if (rings_[s].count) frames = std::min(frames, *rings_[s].count);
  }
  ended_ = frames < to && times.first > static_cast<double>(frames - 1);
  const auto& info = sources_.front()->info();
  std::vector<cv::Mat> out{cv::Mat(map_.size, CV_MAKETYPE(info.depth, info.channels))};
  with_depth(info.depth, [&]<class T>(T) {
    const auto value = [&](const SourcePixel& pixel, int frame) {
      const Ring& ring = rings_[static_cast<std::size_t>(pixel.source)];
      const auto index =
          std::clamp<std::int64_t>(frame - ring.first, 0, static_cast<std::int64_t>(ring.frames.size()) - 1);
      return ring.frames[static_cast<std::size_t>(index)].template ptr<T>(pixel.y) +
             static_cast<std::ptrdiff_t>(pixel.x) * info.channels;
    };
    core::parallel_for(static_cast<std::size_t>(map_.size.height), {}, [&](std::size_t y) {
      render_row<T>(map_, control_, static_cast<int>(frames), frame_, static_cast<int>(y), out, value);
    });
  });
  ++frame_;
  return out.front();
}

}  // namespace emberfold::dytex
