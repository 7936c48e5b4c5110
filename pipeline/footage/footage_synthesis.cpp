// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage_synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "pipeline/footage/between_frames.hpp"
#include "pipeline/footage/seams.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kStretch = 0.15;     // share by which content is stretched where it moves
constexpr double kRange = 1.0 / 3;    // share of the smaller side over which the time front is smooth
constexpr double kMostAmplitude = 5;  // frames: enough for slow clips to look new
constexpr double kLeastMotion = 0.5;  // px per frame: slower content is stretched no further
// Error of frames drawn between their neighbours. Below kKnown times differ freely, above kUnknown not at
// all, since interpolation is unreliable there.
constexpr double kKnown = 0.6, kUnknown = 0.8;
constexpr double kRate = 0.2;                      // SD of the relative speed of local time
constexpr double kFewTimes = 0.5;                  // frames: smaller amplitudes need several plays
constexpr int kPlays = 3;                          // enough that none fills most of the frame
constexpr int kApart = 6;                          // frames between those shown side by side, at least
constexpr std::uint64_t kPlayStream = 0x706c6179;  // between the seeds of plays
constexpr double kSame = 0.05;                     // share of the usual change: an invisible jump
constexpr double kLead = 2;                        // frames by which times differ in the first frame
constexpr double kLeadRate = 0.3;                  // frames added per frame of the footage

std::shared_ptr<const std::vector<cv::Mat>> in_playing_order(std::vector<cv::Mat> footage,
                                                             const FootageSynthesisOptions& options) {
  if (!(std::abs(options.speed) <= 100) || options.speed == 0)
    throw core::InputError("FootageSynthesisOptions.speed is " + std::to_string(options.speed) +
                           "; allowed is -100 to 100, but not 0");
  if (options.loop && *options.loop < 2)
    throw core::InputError("FootageSynthesisOptions.loop is " + std::to_string(*options.loop) +
                           "; allowed is 2 or more");
  if (footage.size() < 2) throw core::InputError("a footage of one frame has no motion to play");
  if (options.speed < 0) std::ranges::reverse(footage);
  return std::make_shared<const std::vector<cv::Mat>>(std::move(footage));
}

std::optional<int> played_loop(const FootageSynthesisOptions& options) {
  if (!options.loop) return {};
  return std::max(2, static_cast<int>(std::lround(*options.loop * std::abs(options.speed))));
}

/// Returns whether the footage itself repeats after the loop: then its own frames have no seam.
bool repeats(const LikeMoments& moments, const FootageSynthesisOptions& options) {
  if (!options.loop || !moments.can_jump()) return false;
  const PlayOrder order(moments, {.loop = played_loop(options)});
  return !order.plays_back() && order.relative_cost() < kSame;
}

TimeFront make_front(const std::vector<cv::Mat>& footage, const FootageSynthesisOptions& options,
                     const MotionScale& scale, const LikeMoments& moments) {
  const double range = kRange * std::min(footage.front().cols, footage.front().rows);
  const double known = std::clamp((kUnknown - scale.between_error) / (kUnknown - kKnown), 0.0, 1.0);
  const double slope = known * kStretch / std::max(kLeastMotion, scale.speed);
  const double amplitude =
      repeats(moments, options)
          ? 0
          : std::min({slope * range, kMostAmplitude, static_cast<double>(footage.size()) / 10});
  return {amplitude, range, kRate * std::abs(options.speed), options.seed, options.loop};
}

/// Returns the plays of a footage: several side by side where times within a single one can hardly differ.
PlayedFrames make_plays(const std::shared_ptr<const std::vector<cv::Mat>>& footage,
                        const FootageSynthesisOptions& options, const MotionScale& scale,
                        const LikeMoments& moments, double amplitude) {
  const auto loop = played_loop(options);
  const int plays = amplitude < kFewTimes && !repeats(moments, options) ? kPlays : 1;
  const auto seams = std::make_shared<const Seams>(*footage, scale.moves, plays);
  std::vector<std::shared_ptr<PlayOrder>> orders;
  for (int i = 0; i < plays; ++i) {
    PlayOrderOptions order{.seed = options.seed + kPlayStream * static_cast<std::uint64_t>(i), .loop = loop};
    if (loop) order.shift = *loop * i / plays;
    if (i > 0)
      order.beside = [seams, other = orders.back(), seam = i - 1,
                      apart = std::min(kApart, moments.frames / 4)](std::int64_t moment, int frame) {
        const auto shown = other->at(moment).frame;
        return std::abs(shown - frame) < apart ? std::numeric_limits<double>::infinity()
                                               : seams->visibility(seam, shown, frame);
      };
    orders.push_back(std::make_shared<PlayOrder>(moments, std::move(order)));
  }
  return {footage, std::move(orders), seams, loop};
}

}  // namespace

FootageSynthesis::FootageSynthesis(std::vector<cv::Mat> footage, const FootageSynthesisOptions& options,
                                   const core::Context& context)
    : footage_(in_playing_order(std::move(footage), options)),
      options_(options),
      scale_(measure_motion_scale(*footage_, context)),
      moments_(compare_moments(*footage_, context)),
      front_(make_front(*footage_, options, scale_, moments_)),
      played_(make_plays(footage_, options, scale_, moments_, amplitude())),
      copied_(*footage_, scale_.moves) {}

double FootageSynthesis::step() const {
  return options_.loop ? double(*played_loop(options_)) / *options_.loop : std::abs(options_.speed);
}

double FootageSynthesis::bound(std::int64_t frame) const {
  if (options_.loop) return front_.bound();
  return std::min(front_.bound(), kLead + kLeadRate * step() * static_cast<double>(frame));
}

double FootageSynthesis::time(std::int64_t frame) const {
  return std::ceil(bound(0)) + 1 + step() * static_cast<double>(frame);
}

int FootageSynthesis::batch() const {
  const auto& frame = footage_->front();
  const auto most = core::frames_at_once(frame.cols, frame.rows, frame.channels());
  return std::max(1, static_cast<int>(static_cast<double>(most) / std::max(1.0, std::abs(options_.speed))));
}

void FootageSynthesis::each(int count, const std::function<void(cv::Mat)>& take,
                            const core::Context& context) {
  while (count > 0) {
    const int some = std::min(count, batch());
    const auto first = static_cast<std::int64_t>(std::floor(time(next_) - bound(next_)));
    const auto last =
        static_cast<std::int64_t>(std::floor(time(next_ + some - 1) + bound(next_ + some - 1))) + 1;
    played_.prepare(first, last + 1, context);
    std::vector<MovingFrame> moving;
    for (auto n = first; n <= last; ++n) moving.push_back({&played_.frame(n), &played_.motion(n)});
    std::vector<cv::Mat> drawn(static_cast<std::size_t>(some));
    core::parallel_for(drawn.size(), context, [&](std::size_t i) {
      const auto n = next_ + static_cast<std::int64_t>(i);
      const auto offsets = front_.at(static_cast<double>(n), footage_->front().size(), bound(n));
      drawn[i] = draw_between(moving, time(n) - static_cast<double>(first), offsets);
    });
    for (auto& frame : drawn) {
      if (next_ % CopiedShare::kEvery == 0) copied_.add(frame);
      take(std::move(frame));
      ++next_;
      --count;
    }
  }
}

graph::MotionGraph FootageSynthesis::motion(int /*count*/, const core::Context& /*context*/) const {
  throw core::InputError("a clip of footage draws no strokes");
}

}  // namespace emberfold::pipeline
