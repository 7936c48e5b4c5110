// SPDX-License-Identifier: Apache-2.0
#include "apps/residual_texture.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/interrupt.hpp"
#include "apps/model_arrays.hpp"
#include "core/error.hpp"
#include "sketch/fill.hpp"

namespace emberfold::apps {

namespace {

constexpr std::size_t kPairs = 20;
constexpr int kMargin = 3;            // px beside a patch that its own misfit may tell in
constexpr float kLeastStrength = 0.5F;  // grey levels: of less, rounding is all there is
constexpr double kSeenShare = 0.02;   // of a cell's pixels over all frames, to tell how strong it is
constexpr double kOfBlue = 0.114, kOfRed = 0.299, kOfGreen = 0.587;

/// What a frame shows beyond its drawing, and where that may be looked at.
struct Residual {
  cv::Mat values;  // CV_32F
  cv::Mat seen;    // CV_8U
};

class ResidualReader {
 public:
  ResidualReader(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                 const FrameLook& look, const core::Context& context)
      : source_(source), graphs_(graphs), painter_(look), size_(look.size), context_(context) {}

  /// Hands over the pairs of frames.
  template <class Visit>
  void each_pair(const Visit& visit) {
    const std::size_t gaps = graphs_.size() - 1, pairs = std::min(kPairs, gaps);
    source_.rewind();
    std::size_t t = 0;
    cv::Mat frame = source_.next();
    for (std::size_t i = 0; i < pairs; ++i) {
      for (; t < i * gaps / pairs; ++t) frame = next();
      const Residual now = of(frame, graphs_[t]);
      frame = next();
      visit(now, of(frame, graphs_[++t]));
    }
  }

 private:
  cv::Mat next() {
    if (context_.cancelled()) throw Interrupted{};
    return source_.next();
  }
  Residual of(const cv::Mat& frame, const graph::AttributeGraph& graph) const {
    cv::Mat drawn, patches;
    painter_.draw({graph}).convertTo(drawn, CV_32F);
    const int side = 2 * kMargin + 1;
    cv::dilate(sketch::draw_fitted(graph, size_, 1).mask, patches, cv::Mat::ones(side, side, CV_8U));
    return {core::to_levels(frame, source_.info()) - drawn, patches == 0};
  }

  core::FrameSource& source_;
  std::span<const graph::AttributeGraph> graphs_;
  FramePainter painter_;
  cv::Size size_;
  const core::Context& context_;
};

cv::Size cells(cv::Size frame) {
  return {(frame.width + kGroundCell - 1) / kGroundCell, (frame.height + kGroundCell - 1) / kGroundCell};
}

/// Each cell's mean over its pixels in the frame.
cv::Mat over_cells(const cv::Mat& values) {
  const cv::Size count = cells(values.size());
  cv::Mat whole, means;
  cv::copyMakeBorder(values, whole, 0, count.height * kGroundCell - values.rows, 0,
                     count.width * kGroundCell - values.cols, cv::BORDER_REPLICATE);
  cv::resize(whole, means, count, 0, 0, cv::INTER_AREA);
  return means;
}

/// Linear between the middles of cells.
cv::Mat spread(const cv::Mat& values, cv::Size frame) {
  cv::Mat whole;
  cv::resize(values, whole, {values.cols * kGroundCell, values.rows * kGroundCell}, 0, 0, cv::INTER_LINEAR);
  return whole(cv::Rect({0, 0}, frame)).clone();
}

/// Luma, and blue and red less luma.
std::vector<cv::Mat> parts_of(const cv::Mat& levels) {
  if (levels.channels() == 1) return {levels};
  std::array<cv::Mat, 3> colours;
  cv::split(levels, colours.data());
  const cv::Mat luma = core::luma(levels);
  return {luma, colours[0] - luma, colours[2] - luma};
}

cv::Mat levels_of(const std::vector<cv::Mat>& parts) {
  if (parts.size() == 1) return parts[0];
  const cv::Mat green = parts[0] - (kOfBlue * parts[1] + kOfRed * parts[2]) / kOfGreen;
  cv::Mat levels;
  cv::merge(std::vector<cv::Mat>{parts[0] + parts[1], green, parts[0] + parts[2]}, levels);
  return levels;
}

/// Luma's SD by cell; what was hardly seen takes it from cells around. Empty where nothing was seen.
cv::Mat measure_strength(ResidualReader& reader, cv::Size frame) {
  cv::Mat squares = cv::Mat::zeros(cells(frame), CV_32F), counts = squares.clone();
  int frames = 0;
  reader.each_pair([&](const Residual& now, const Residual& next) {
    for (const auto* residual : {&now, &next}) {
      cv::Mat seen;
      residual->seen.convertTo(seen, CV_32F, 1 / 255.0);
      const cv::Mat luma = core::luma(residual->values);
      squares += over_cells(luma.mul(luma).mul(seen));
      counts += over_cells(seen);
      ++frames;
    }
  });
  const cv::Mat known = counts > kSeenShare * frames;
  if (cv::countNonZero(known) == 0) return {};
  cv::Mat strength;
  cv::sqrt(squares / cv::max(counts, 1e-6), strength);
  return sketch::fill(strength, known).levels;
}

}  // namespace

ResidualTexture measure_residual(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                 const FrameLook& look, const core::Context& context) {
  if (graphs.size() < 2) return {};
  ResidualReader reader(source, graphs, look, context);
  ResidualTexture residual;
  residual.strength = measure_strength(reader, look.size);
  if (residual.strength.empty()) return {};
  const cv::Mat unit = cv::max(spread(residual.strength, look.size), kLeastStrength);
  std::vector<dytex::GaussianTextureLearner> learners(static_cast<std::size_t>(look.channels == 1 ? 1 : 3),
                                                      dytex::GaussianTextureLearner(look.size));
  reader.each_pair([&](const Residual& now, const Residual& next) {
    const auto before = parts_of(now.values), after = parts_of(next.values);
    for (std::size_t i = 0; i < learners.size(); ++i)
      learners[i].add(before[i] / unit, now.seen, after[i] / unit, next.seen);
  });
  for (const auto& learner : learners) residual.textures.push_back(learner.learned());
  return residual;
}

ResidualFrames::ResidualFrames(const ResidualTexture& residual, cv::Size frame, std::uint64_t seed)
    : strength_(spread(residual.strength, frame)) {
  for (std::size_t i = 0; i < residual.textures.size(); ++i)
    frames_.emplace_back(residual.textures[i], frame, seed, static_cast<std::uint32_t>(i));
}

cv::Mat ResidualFrames::next() {
  std::vector<cv::Mat> parts;
  for (auto& frames : frames_) parts.push_back(frames.next().mul(strength_));
  cv::Mat bytes;
  levels_of(parts).convertTo(bytes, CV_8S);
  return bytes;
}

void add_residual(core::ModelArchive& archive, const ResidualTexture& residual) {
  if (residual.empty()) return;
  std::vector<cv::Mat> within, ahead;
  for (const auto& texture : residual.textures) {
    within.push_back(texture.within);
    ahead.push_back(texture.ahead);
  }
  cv::Mat all_within, all_ahead;
  cv::merge(within, all_within);
  cv::merge(ahead, all_ahead);
  archive.arrays["residual_within"] = float_array(all_within);
  archive.arrays["residual_ahead"] = float_array(all_ahead);
  archive.arrays["residual_strength"] = float_array(residual.strength);
}

ResidualTexture read_residual(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("residual_within") && !archive.arrays.contains("residual_ahead") &&
      !archive.arrays.contains("residual_strength"))
    return {};
  const cv::Size lags(dytex::kTextureLags, dytex::kTextureLags);
  const int count = channels_of(archive, "residual_within");
  std::vector<cv::Mat> within, ahead;
  cv::split(read_floats(archive, "residual_within", lags, count), within);
  cv::split(read_floats(archive, "residual_ahead", lags, count), ahead);
  ResidualTexture residual;
  for (std::size_t i = 0; i < within.size(); ++i) residual.textures.push_back({within[i], ahead[i]});
  residual.strength = read_floats(archive, "residual_strength", cells(frame), 1);
  double least = 0;
  cv::minMaxIdx(residual.strength, &least);
  if (least < 0) throw core::IoError("motion model: residual_strength.npy holds a number below 0");
  return residual;
}

}  // namespace emberfold::apps
