// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/pictures.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/match_picture.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/pictures/png.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/io/clip_writer.hpp"

namespace emberfold::apps {

namespace {

constexpr std::size_t kMeasuredFrames = 24;  // reconstructed for the figures unless all frames are

// The frames of each kind of picture, chosen before the clip is read.
struct Plan {
  std::set<int> stills, event_frames, measured, gaps;
  std::size_t still_bytes = 0, event_bytes = 0, match_bytes = 0;
};

std::set<int> spread_middles(int frames, std::size_t count) {
  std::set<int> chosen;
  const auto parts = static_cast<int>(std::min<std::size_t>(count, static_cast<std::size_t>(frames)));
  for (int i = 0; i < parts; ++i)
    chosen.insert(static_cast<int>((2 * i + 1) * static_cast<std::int64_t>(frames) / (2 * parts)));
  return chosen;
}

Plan make_plan(int frames, std::span<const graph::Event> events, bool all) {
  Plan plan;
  plan.stills = spread_middles(frames, kStills);
  plan.measured = spread_middles(frames, all ? static_cast<std::size_t>(frames) : kMeasuredFrames);
  std::vector<int> eventful;
  for (const auto& event : events)
    if (eventful.empty() || eventful.back() != event.frame) eventful.push_back(event.frame);
  for (const int t : spread_evenly(eventful, kEventFrames)) plan.event_frames.insert(t);
  for (const int t : eventful_gaps(events, kMatches)) plan.gaps.insert(t);
  const auto each = [](std::size_t bytes, std::size_t count) {
    return bytes / std::max<std::size_t>(1, count);
  };
  plan.still_bytes = each(kStillBytes, 3 * plan.stills.size());
  plan.event_bytes = std::min<std::size_t>(60'000, each(kEventFrameBytes, plan.event_frames.size()));
  plan.match_bytes = each(kMatchBytes, plan.gaps.size());
  return plan;
}

// The pictures of one frame, drawn on any thread.
struct DrawnFrame {
  cv::Mat bytes, overlay;
  std::optional<pipeline::Reconstruction> reconstruction;
  pipeline::GainTotals gains;
  std::optional<ReportStill> still;
  std::optional<Still> event_frame;
};

DrawnFrame draw_picture_set(const cv::Mat& frame, int t, const core::ClipInfo& info,
                            const graph::AttributeGraph& graph, std::span<const graph::Event> events,
                            const Plan& plan) {
  constexpr int kStillSide = 960, kEventSide = 720;
  DrawnFrame drawn;
  drawn.bytes = to_colour_bytes(frame, info);
  drawn.overlay = draw_overlay(drawn.bytes, graph, t, events);
  if (plan.event_frames.contains(t))
    drawn.event_frame = make_still(drawn.bytes, kEventSide, plan.event_bytes);
  if (!plan.measured.contains(t) && !plan.stills.contains(t)) return drawn;
  const cv::Mat levels = core::to_levels(frame, info);
  drawn.reconstruction = pipeline::reconstruct(levels, graph, pipeline::PatchDrawing::fitted);
  drawn.gains = pipeline::total_gain(levels, graph);
  if (plan.stills.contains(t)) {
    drawn.still = ReportStill{t,
                              make_still(drawn.bytes, kStillSide, plan.still_bytes),
                              make_still(draw_sketch(drawn.bytes, graph), kStillSide, plan.still_bytes),
                              make_still(drawn.reconstruction->bytes, kStillSide, plan.still_bytes),
                              drawn.reconstruction->psnr,
                              drawn.reconstruction->share};
  }
  return drawn;
}

std::string match_name(int t) {
  const auto padded = [](int number) {
    const std::string digits = std::to_string(number);
    return std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits;
  };
  return "matches/match_" + padded(t - 1) + "_" + padded(t) + ".png";
}

// Collects and writes the drawn pictures, in the order of frames.
class Collector {
 public:
  Collector(const graph::MotionGraph& motion, std::span<const graph::Event> events, const Plan& plan,
            bool reconstructs, const core::ClipInfo& info, io::OutputFolder& output)
      : motion_(motion),
        events_(events),
        plan_(plan),
        reconstructs_(reconstructs),
        info_(info),
        output_(output) {
    if (!plan.gaps.empty()) output_.make_subfolder("matches");
  }

  void take(int t, DrawnFrame drawn) {
    if (!overlay_)
      overlay_ = io::create_video(output_.staged("overlay.mp4"), drawn.overlay.size(), info_.fps, true);
    overlay_->write(drawn.overlay);
    if (sum_.empty()) sum_ = cv::Mat(drawn.bytes.size(), CV_32FC3, cv::Scalar::all(0));
    cv::accumulate(drawn.bytes, sum_);
    ++frames_;
    pictures_.gains.add(drawn.gains);
    if (drawn.reconstruction) take_reconstruction(*drawn.reconstruction);
    if (drawn.still) pictures_.report.stills.push_back(std::move(*drawn.still));
    if (drawn.event_frame) pictures_.report.event_frames.push_back({t, std::move(*drawn.event_frame)});
    if (plan_.gaps.contains(t)) {
      const cv::Mat match = draw_match(before_, drawn.bytes, motion_, t, events_);
      write_png(output_, match_name(t), match);
      pictures_.report.matches.push_back({t, make_still(match, 1800, plan_.match_bytes)});
    }
    before_ = drawn.bytes;
  }

  Pictures finish() {
    if (overlay_) overlay_->finish();
    if (reconstruction_) reconstruction_->finish();
    if (frames_ > 0) sum_.convertTo(pictures_.mean, CV_8U, 1.0 / frames_);
    return std::move(pictures_);
  }

 private:
  void take_reconstruction(const pipeline::Reconstruction& made) {
    pictures_.share.push_back(made.share);
    pictures_.psnr.push_back(made.psnr);
    pictures_.not_converged += made.converged ? 0 : 1;
    if (!reconstructs_) return;
    if (!reconstruction_)
      reconstruction_ = io::create_video(output_.staged("reconstruction.avi"), made.bytes.size(), info_.fps,
                                         made.bytes.channels() == 3);
    reconstruction_->write(made.bytes);
  }

  const graph::MotionGraph& motion_;
  std::span<const graph::Event> events_;
  const Plan& plan_;
  bool reconstructs_;
  const core::ClipInfo& info_;
  io::OutputFolder& output_;
  std::unique_ptr<io::VideoWriter> overlay_, reconstruction_;
  cv::Mat before_, sum_;
  int frames_ = 0;
  Pictures pictures_;
};

}  // namespace

Pictures draw_pictures(core::FrameSource& source, const graph::MotionGraph& motion,
                       std::span<const graph::Event> events, bool reconstructs, io::OutputFolder& output,
                       const Session& session) {
  const auto& info = source.info();
  const auto& graphs = motion.sketch.frames;
  const Plan plan = make_plan(static_cast<int>(graphs.size()), events, reconstructs);
  Collector collector(motion, events, plan, reconstructs, info, output);
  try {
    const int frames = core::stream_frames(
        source, "pictures", static_cast<std::int64_t>(graphs.size()), session.context,
        [&](int t, const cv::Mat& frame) {
          if (static_cast<std::size_t>(t) >= graphs.size())
            throw core::IoError("the clip has more frames now than when it was sketched");
          return draw_picture_set(frame, t, info, graphs[static_cast<std::size_t>(t)], events, plan);
        },
        [&](int t, DrawnFrame drawn) { collector.take(t, std::move(drawn)); });
    if (static_cast<std::size_t>(frames) != graphs.size())
      throw core::IoError("the clip has fewer frames now than when it was sketched");
    return collector.finish();
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
}

}  // namespace emberfold::apps
