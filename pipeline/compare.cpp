// SPDX-License-Identifier: Apache-2.0
#include "pipeline/compare.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/text/check_range.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/measures/spectra.hpp"
#include "dytex/measures/ssim.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/clip_profile.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/comparison/visible_measures.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kBatch = 16;  // frames of each clip that are held at once

int count_frames(core::FrameSource& source, int clip, const core::Context& context) {
  source.rewind();
  int frames = 0;
  while (!source.next().empty()) {
    ++frames;
    context.check();
  }
  if (frames < kFewestFrames) throw ShortClipError(clip, frames);
  return frames;
}

// Returns why two clips have no PSNR; empty where they have one.
std::string why_no_psnr(const core::ClipInfo& a, int frames_a, const core::ClipInfo& b, int frames_b) {
  if (a.width != b.width || a.height != b.height) return "the sizes differ";
  if (a.channels != b.channels) return "one is grey, the other in colour";
  return frames_a != frames_b ? "the lengths differ" : "";
}

struct ClipPair {
  core::FrameSource &a, &b;
  int frames_a = 0, frames_b = 0;
  SourceMeasures measures_a;
  ClipMeasures measures_b;
  ClipStrokes strokes_a, strokes_b;
  double square_error = 0, similarity = 0;                // sums over frames
  std::vector<cv::Mat> pictures_a = {}, pictures_b = {};  // visible_pictures
};

void add_luma(std::span<const cv::Mat> levels, auto& measures, std::vector<cv::Mat>& pictures,
              const core::Context& context) {
  const auto luma = levels_to_luma(levels);
  measures.add(luma, context);
  for (const auto& one : luma)
    if (pictures.size() < VisibleMeasures::kMostFrames) pictures.push_back(visible_picture(one));
}

void pass_on(const CompareObserver& observer, int first, std::span<const cv::Mat> a,
             std::span<const cv::Mat> b) {
  if (!observer.take) return;
  std::array<std::vector<cv::Mat>, 2> clips;
  for (const auto& levels : a) clips[0].push_back(core::to_bytes(levels));
  for (const auto& levels : b) clips[1].push_back(core::to_bytes(levels));
  observer.take(first, clips);
}

void measure_pair(ClipPair& pair, bool with_psnr, const core::Context& context,
                  const CompareObserver& observer) {
  const int most = std::max(pair.frames_a, pair.frames_b);
  pair.a.rewind(), pair.b.rewind();
  for (int t = 0; t < most; t += kBatch) {
    context.report("compare", double(t) / most);
    const auto a = next_levels(pair.a, kBatch, context), b = next_levels(pair.b, kBatch, context);
    add_luma(a, pair.measures_a, pair.pictures_a, context);
    add_luma(b, pair.measures_b, pair.pictures_b, context);
    pair.strokes_a.add(a, context);
    pair.strokes_b.add(b, context);
    for (std::size_t i = 0; with_psnr && i < std::min(a.size(), b.size()); ++i) {
      pair.square_error += dytex::mean_square_error(a[i], b[i]);
      pair.similarity += dytex::structural_similarity(core::luma(a[i]), core::luma(b[i]));
    }
    pass_on(observer, t, a, b);
  }
}

}  // namespace

void CompareOptions::validate() const {
  core::check_fields("CompareOptions", *this);
}

ShortClipError::ShortClipError(int which, int count)
    : core::InputError(short_clip_text(which == 0 ? "the clip" : "the other clip", count)),
      clip(which),
      frames(count) {}

std::string short_clip_text(const std::string& name, int frames) {
  if (frames <= 0) return name + " holds no frame";
  return name + " holds " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
         "; a comparison needs at least " + std::to_string(kFewestFrames);
}

ClipComparison compare(core::FrameSource& a, core::FrameSource& b, const CompareOptions& options,
                       const core::Context& context, const CompareObserver& observer) {
  options.validate();
  ClipComparison out;
  out.frames_a = count_frames(a, 0, context);
  out.frames_b = count_frames(b, 1, context);
  const core::ClipInfo &info_a = a.info(), &info_b = b.info();
  const cv::Size size_a(info_a.width, info_a.height), size_b(info_b.width, info_b.height);
  out.scale = measure_scale(std::min(out.frames_a / 2, out.frames_b), size_a);
  out.scale.rings = std::min(out.scale.rings, dytex::ring_count(size_b));
  ClipPair pair{a,
                b,
                out.frames_a,
                out.frames_b,
                SourceMeasures(size_a, out.scale, out.frames_a),
                ClipMeasures(size_b, out.scale, out.frames_b),
                ClipStrokes(size_a, info_a.fps, options.sketch, options.match),
                ClipStrokes(size_b, info_b.fps, options.sketch, options.match)};
  out.no_psnr_reason = why_no_psnr(info_a, out.frames_a, info_b, out.frames_b);
  const bool with_psnr = out.no_psnr_reason.empty();
  if (observer.begin) {
    const std::array<ObservedClip, 2> clips{
        {{"a", "the first clip", info_a, out.frames_a}, {"b", "the other clip", info_b, out.frames_b}}};
    observer.begin(clips);
  }
  measure_pair(pair, with_psnr, context, observer);

  const mcmc::StrokeSeries series = pair.strokes_a.series(context);
  const OptionalStrokes strokes_a = mcmc::stroke_statistics(series);
  const OptionalStrokes strokes_b = mcmc::stroke_statistics(pair.strokes_b.series(context));
  out.a = clip_profile(pair.measures_a.all, strokes_a);
  out.b = clip_profile(pair.measures_b, strokes_b);
  out.distances = clip_distances(pair.measures_b, strokes_b, pair.measures_a.all, strokes_a);
  out.distances.visible =
      VisibleMeasures(std::move(pair.pictures_a), context).measure(std::move(pair.pictures_b), context);
  out.noise_floor = noise_floor(pair.measures_a, &series);
  if (with_psnr) {
    out.psnr = dytex::psnr(pair.square_error / out.frames_a);
    out.ssim = pair.similarity / out.frames_a;
  }
  return out;
}

}  // namespace emberfold::pipeline
