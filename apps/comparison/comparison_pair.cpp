// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <span>

#include <opencv2/core.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/comparison/comparison.hpp"
#include "apps/comparison/comparison_json.hpp"
#include "apps/comparison/comparison_words.hpp"
#include "apps/pictures/side_by_side.hpp"
#include "core/error.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/measures/ssim.hpp"
#include "pipeline/clip_strokes.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kBatch = 16;

int count_frames(core::FrameSource& source, const std::string& name, const Session& session) {
  source.rewind();
  int frames = 0;
  while (!source.next().empty()) {
    ++frames;
    session.check_stop();
  }
  need_frames(name, frames);
  return frames;
}

// Why there is no PSNR between two clips; empty where there is.
std::string why_no_psnr(const core::ClipInfo& a, int frames_a, const core::ClipInfo& b, int frames_b) {
  if (a.width != b.width || a.height != b.height) return "the sizes differ";
  if (a.channels != b.channels) return "one is grey, the other in colour";
  return frames_a != frames_b ? "the lengths differ" : "";
}

struct Pair {
  core::FrameSource &a, &b;
  int frames_a = 0, frames_b = 0;
  pipeline::SourceMeasures measures_a;
  pipeline::ClipMeasures measures_b;
  pipeline::ClipStrokes strokes_a, strokes_b;
  double square_error = 0, similarity = 0;  // sums over frames
  std::vector<ComparedFrame> pictures = {};
};

void run_through(Pair& pair, bool alike, bool with_strokes, SideBySide& beside, const PanelRow& panels,
                 const std::vector<std::string>& labels, const Session& session) {
  const int most = std::max(pair.frames_a, pair.frames_b), both = std::min(pair.frames_a, pair.frames_b);
  pair.a.rewind(), pair.b.rewind();
  for (int t = 0; t < most; t += kBatch) {
    session.context.report("compare", double(t) / most);
    const auto a = next_levels(pair.a, kBatch, session), b = next_levels(pair.b, kBatch, session);
    pair.measures_a.add(pipeline::luma_of(a), session.context);
    pair.measures_b.add(pipeline::luma_of(b), session.context);
    if (with_strokes) {
      pair.strokes_a.add(a, session.context);
      pair.strokes_b.add(b, session.context);
    }
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      if (alike) {
        pair.square_error += dytex::mean_square_error(a[i], b[i]);
        pair.similarity += dytex::structural_similarity(core::luma(a[i]), core::luma(b[i]));
      }
      const std::vector<cv::Mat> row{core::to_bytes(a[i]), core::to_bytes(b[i])};
      beside.write(row);
      const int frame = t + static_cast<int>(i);
      if (frame == both / 4 || frame == both * 3 / 4)
        pair.pictures.push_back({frame, panels.compose(row, labels)});
    }
  }
}

// Distances of b from a, and of a's halves from each other, and what both clips are like.
void add_distances(const Pair& pair, bool with_strokes, const Session& session, Json& measures) {
  std::optional<mcmc::StrokeSeries> series;
  std::optional<mcmc::StrokeStatistics> a, b;
  if (with_strokes) {
    series = pair.strokes_a.series(session.context);
    a = mcmc::stroke_statistics(*series);
    b = mcmc::stroke_statistics(pair.strokes_b.series(session.context));
  }
  const auto& source = pair.measures_a;
  measures["distances"] = {{"other", held_json(pair.measures_b, b, source.all, a)},
                           {"noise_floor", noise_floor_json(source, series ? &*series : nullptr)},
                           {"source", own_json(source.all, a)}};
}

}  // namespace

Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, const pipeline::CompareOptions& options,
                         io::OutputFolder& output, Session& session) {
  options.validate();
  const int frames_a = count_frames(a, name_a, session), frames_b = count_frames(b, name_b, session);
  const cv::Size size_a(a.info().width, a.info().height), size_b(b.info().width, b.info().height);
  auto scale = pipeline::measure_scale(std::min(frames_a / 2, frames_b), size_a);
  scale.rings = std::min(scale.rings, dytex::ring_count(size_b));
  const auto strokes = [&](cv::Size size, double fps) {
    return pipeline::ClipStrokes(size, fps, options.sketch, options.match);
  };
  Pair pair{a,
            b,
            frames_a,
            frames_b,
            pipeline::SourceMeasures(size_a, scale, frames_a),
            pipeline::ClipMeasures(size_b, scale, frames_b),
            strokes(size_a, a.info().fps),
            strokes(size_b, b.info().fps)};
  const auto missing = why_no_psnr(a.info(), frames_a, b.info(), frames_b);
  try {
    const auto label = [](const std::string& name) {
      return std::filesystem::path(name).filename().string();
    };
    const std::vector<std::string> labels{label(name_a), label(name_b)};
    const std::vector<cv::Size> sizes{size_a, size_b};
    SideBySide beside(output.staged("side_by_side.mp4"), labels, sizes, a.info().fps);
    run_through(pair, missing.empty(), options.strokes, beside, PanelRow(sizes), labels, session);
    beside.finish();
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
  Json measures = begin_measures(scale);
  measures["clip"] = clip_json(name_a, a.info(), frames_a);
  measures["other"] = clip_json(name_b, b.info(), frames_b);
  add_distances(pair, options.strokes, session, measures);
  measures["psnr"] =
      missing.empty() ? Json(pipeline::rounded(dytex::psnr(pair.square_error / frames_a))) : Json(nullptr);
  measures["ssim"] = missing.empty() ? Json(pipeline::rounded(pair.similarity / frames_a)) : Json(nullptr);
  if (!missing.empty()) measures["psnr_missing"] = missing;
  measures["curves"] = curves_json({{"source", &pair.measures_a.all}, {"other", &pair.measures_b}}, scale);
  measures["words"] = comparison_words(measures);
  measures["warnings"] = session.warnings;
  write_measures(measures, output);
  return {std::move(measures), {"measures.json", "side_by_side.mp4"}, std::move(pair.pictures)};
}

}  // namespace emberfold::apps
