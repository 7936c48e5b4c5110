// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_heat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/sketching/sketch_film.hpp"
#include "core/clip/clip_range.hpp"
#include "core/io/clip_writer.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/inpainting/heat_flow.hpp"

namespace emberfold::apps {

namespace {

constexpr double kNear = 0.5;        // grey levels: indistinguishable from the state at rest
constexpr std::int64_t kBlock = 64;  // steps between two checks of the context

double largest_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

cv::Mat moment_picture(const HeatMoment& moment, int frame) {
  cv::Mat bytes = core::to_bytes(moment.levels), colour;
  if (bytes.channels() == 1)
    cv::cvtColor(bytes, colour, cv::COLOR_GRAY2BGR);
  else
    colour = bytes;
  const cv::Mat picture = enlarge(colour, enlargement(colour.size(), OverlayOptions{}.shorter_side));
  std::array<char, 96> text{};
  if (moment.at_rest)
    std::snprintf(text.data(), text.size(), "   diffusion at rest");
  else
    std::snprintf(text.data(), text.size(), "   diffusion at time %.2f px^2 (step %lld)", moment.time,
                  static_cast<long long>(moment.steps));
  const cv::Mat legend = draw_legend(picture.cols, frame_label(frame) + text.data(), {});
  cv::Mat whole;
  cv::vconcat(picture, legend, whole);
  return whole;
}

}  // namespace

std::vector<std::int64_t> heat_steps(std::int64_t last, int count) {
  std::vector<std::int64_t> steps{0};
  for (int left = count - 1; left > 0 && steps.back() < last; --left) {
    const auto now = static_cast<double>(std::max<std::int64_t>(1, steps.back()));
    const double next = steps.back() == 0 ? 1 : now * std::pow(static_cast<double>(last) / now, 1.0 / left);
    const auto whole = left == 1 ? last : static_cast<std::int64_t>(std::llround(next));
    steps.push_back(std::min(last, std::max(steps.back() + 1, whole)));
  }
  return steps;
}

std::int64_t steps_to_rest(const cv::Mat& mask) {
  if (cv::countNonZero(mask) == 0) return 1;
  cv::Mat distance;
  cv::distanceTransform(mask == 0, distance, cv::DIST_L2, cv::DIST_MASK_5);
  double most = 0;
  cv::minMaxLoc(distance, nullptr, &most);
  // The slowest mode of a strip 2·most wide decays as exp(−(π / (2·most))² t).
  const double rate = std::pow(std::numbers::pi / (2 * std::max(most, 1.0)), 2);
  return static_cast<std::int64_t>(
      std::ceil(std::log(kOpenLevel / kNear) / rate / sketch::HeatFlow::kLargestStep));
}

bool run_heat(const sketch::Sketchable& held, const cv::Scalar& empty, const HeatOptions& options,
              const core::Context& context, const std::function<void(const HeatMoment&)>& take) {
  const bool any = cv::countNonZero(held.mask) > 0;
  cv::Mat begin = held.levels.clone();
  begin.setTo(any ? cv::Scalar::all(kOpenLevel) : empty, held.mask == 0);
  const cv::Mat rest = any ? sketch::fill(held.levels, held.mask).levels : begin;
  const double values = static_cast<double>(begin.total()) * begin.channels();
  const auto most = std::max<std::int64_t>(1, std::llround(options.most_work / values));
  const auto planned = heat_steps(std::min(most, steps_to_rest(held.mask)), options.moments - 1);
  // Beyond the planned steps it continues with the same ratio.
  const auto& from = planned[planned.size() - 2];
  const double ratio =
      std::max(1.01, static_cast<double>(planned.back()) / std::max<double>(1, double(from)));
  sketch::HeatFlow flow(begin, held.mask);
  bool near = false;
  for (std::size_t i = 0;; ++i) {
    const std::int64_t due =
        i < planned.size()
            ? planned[i]
            : std::max(flow.steps() + 1, static_cast<std::int64_t>(double(flow.steps()) * ratio));
    if (due > most) break;
    while (flow.steps() < due) {
      context.check();
      flow.advance(std::min(kBlock, due - flow.steps()));
      context.report("heat", static_cast<double>(flow.steps()) / static_cast<double>(planned.back()));
    }
    const cv::Mat levels = flow.levels();
    near = largest_difference(levels, rest) < kNear;
    take({levels, flow.steps(), flow.time(), false});
    if (near) break;
  }
  take({rest, flow.steps(), flow.time(), true});
  return near;
}

void write_heat_film(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                     io::OutputFolder& output, Session& session) {
  session.context.report("heat", 0);
  const int t = *request.heat_frame;
  constexpr double kRate = 24;           // pictures per second
  constexpr int kBegin = 12, kEnd = 24;  // pictures for which the first and the last are shown
  const cv::Mat levels = core::to_levels(core::ClipRange(source, t, t + 1).next(), source.info());
  const auto& graph = run.sketch.frames[static_cast<std::size_t>(t)];
  const auto held = pipeline::draw_patches(
      levels, pipeline::add_anchors(graph, levels, request.patches, request.anchors), request.patches);
  std::unique_ptr<io::VideoWriter> video;
  const bool near = run_heat(held, cv::mean(levels), {}, session.context, [&](const HeatMoment& moment) {
    const cv::Mat picture = moment_picture(moment, t);
    if (!video) video = io::create_video(output.staged("heat.mp4"), picture.size(), kRate, true);
    const int times = moment.at_rest ? kEnd : moment.steps == 0 ? kBegin : 1;
    for (int i = 0; i < times; ++i) video->write(picture);
  });
  video->finish();
  if (!near)
    session.warn("heat.mp4: so wide are the gaps between the patches of frame " + std::to_string(t) +
                 " that the diffusion was left before it was at rest; the last picture shows it at rest");
}

}  // namespace emberfold::apps
