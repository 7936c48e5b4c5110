// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <opencv2/core.hpp>

#include "apps/comparison.hpp"
#include "apps/comparison_json.hpp"
#include "apps/comparison_models.hpp"
#include "apps/interrupt.hpp"
#include "apps/reconstruct.hpp"
#include "apps/side_by_side.hpp"
#include "apps/summary.hpp"
#include "core/error.hpp"

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

// The next frames as levels.
std::vector<cv::Mat> read_batch(core::FrameSource& source, const Session& session) {
  std::vector<cv::Mat> levels;
  while (levels.size() < kBatch) {
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    levels.push_back(core::to_levels(frame, source.info()));
    session.check_stop();
  }
  return levels;
}

std::vector<cv::Mat> luma_of(const std::vector<cv::Mat>& levels) {
  std::vector<cv::Mat> luma;
  for (const auto& one : levels) luma.push_back(core::luma(one));
  return luma;
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
  ClipSpectra spectra_a, spectra_b, first, second;
  double square_error = 0;
};

void run_through(Pair& pair, bool with_psnr, SideBySide& beside, const Session& session) {
  const int most = std::max(pair.frames_a, pair.frames_b), half = pair.frames_a / 2;
  pair.a.rewind(), pair.b.rewind();
  for (int t = 0; t < most; t += kBatch) {
    session.context.report("compare", double(t) / most);
    const auto a = read_batch(pair.a, session), b = read_batch(pair.b, session);
    const auto luma_a = luma_of(a), luma_b = luma_of(b);
    pair.spectra_a.add(luma_a, session.context);
    pair.spectra_b.add(luma_b, session.context);
    const auto in_first = static_cast<std::size_t>(std::clamp(half - t, 0, static_cast<int>(a.size())));
    pair.first.add(std::span(luma_a).first(in_first), session.context);
    pair.second.add(std::span(luma_a).subspan(in_first), session.context);
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      if (with_psnr) {
        const double distance = cv::norm(a[i], b[i], cv::NORM_L2);
        pair.square_error += distance * distance;
      }
      beside.write(std::vector<cv::Mat>{core::to_bytes(a[i]), core::to_bytes(b[i])});
    }
  }
}

Json psnr_json(const Pair& pair) {
  const auto& info = pair.a.info();
  const double mse = pair.square_error / (double(info.width) * info.height * info.channels * pair.frames_a);
  return mse > 0 ? std::round(std::min(kMostPsnr, 10 * std::log10(255.0 * 255.0 / mse)) * 1000) / 1000
                 : kMostPsnr;
}

}  // namespace

Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, OutputFolder& output, Session& session) {
  const int frames_a = count_frames(a, name_a, session), frames_b = count_frames(b, name_b, session);
  const cv::Size size_a(a.info().width, a.info().height), size_b(b.info().width, b.info().height);
  const int segment = segment_length(std::min(frames_a / 2, frames_b));
  const int rings = std::min(dytex::ring_count(size_a), dytex::ring_count(size_b));
  const ClipSpectra blank(size_a, segment, rings);
  Pair pair{a, b, frames_a, frames_b, blank, ClipSpectra(size_b, segment, rings), blank, blank};
  const auto missing = why_no_psnr(a.info(), frames_a, b.info(), frames_b);
  try {
    const auto label = [](const std::string& name) {
      return std::filesystem::path(name).filename().string();
    };
    SideBySide beside(output.staged("side_by_side.mp4"), {label(name_a), label(name_b)},
                      std::vector<cv::Size>{size_a, size_b}, a.info().fps);
    run_through(pair, missing.empty(), beside, session);
    beside.finish();
  } catch (const core::IoError& error) {
    throw core::IoError(output.of_final(error.what()));
  }
  Json measures = begin_measures(segment, rings);
  measures["clip"] = clip_json(name_a, a.info(), frames_a);
  measures["other"] = clip_json(name_b, b.info(), frames_b);
  measures["distances"] = {{"other", distances_json(pair.spectra_b, pair.spectra_a)},
                           {"noise_floor", distances_json(pair.first, pair.second)}};
  measures["psnr"] = missing.empty() ? psnr_json(pair) : Json(nullptr);
  if (!missing.empty()) measures["psnr_missing"] = missing;
  measures["spectra"] = curves_json({{"clip", &pair.spectra_a}, {"other", &pair.spectra_b}}, segment, rings);
  measures["warnings"] = session.warnings;
  write_measures(measures, output);
  return {std::move(measures), {"measures.json", "side_by_side.mp4"}};
}

}  // namespace emberfold::apps
