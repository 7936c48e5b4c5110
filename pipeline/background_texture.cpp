// SPDX-License-Identifier: Apache-2.0
#include "pipeline/background_texture.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/estimation/missing_pixels.hpp"
#include "dytex/learn.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::pipeline {

namespace {

using Graphs = std::span<const graph::AttributeGraph>;

constexpr std::size_t most_frames = 5000;  // the limit of dytex::learn
constexpr std::size_t fewest_frames = 6;   // a third of which are two components

cv::Mat sketchable(const graph::AttributeGraph& graph, cv::Size size) {
  return sketch::draw_fitted(graph, size, 1).mask;
}

/// The masks of a sketch, white where patches are.
class MaskSource final : public core::FrameSource {
 public:
  MaskSource(Graphs graphs, const core::ClipInfo& clip) : graphs_(graphs), info_(clip) {
    info_.channels = 1, info_.depth = CV_8U, info_.white = 255;
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override {
    if (position_ == graphs_.size()) return {};
    return sketchable(graphs_[position_++], {info_.width, info_.height});
  }
  void rewind() override { position_ = 0; }

 private:
  Graphs graphs_;
  core::ClipInfo info_;
  std::size_t position_ = 0;
};

/// A clip whose sketchable pixels are filled by diffusion, a batch of frames at a time on several threads.
class GroundSource final : public core::FrameSource {
 public:
  GroundSource(core::FrameSource& source, Graphs graphs, const core::Context& context)
      : source_(source), graphs_(graphs), context_(context) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override {
    if (position_ == ready_.size()) make_ready();
    return position_ < ready_.size() ? std::move(ready_[position_++]) : cv::Mat{};
  }
  void rewind() override {
    source_.rewind();
    ready_.clear();
    position_ = read_ = 0;
  }

 private:
  void make_ready() {
    ready_.clear();
    position_ = 0;
    const auto most = core::frames_at_once(info().width, info().height, info().channels);
    while (ready_.size() < most && read_ + ready_.size() < graphs_.size()) {
      cv::Mat frame = source_.next();
      if (frame.empty()) break;
      ready_.push_back(std::move(frame));
    }
    core::parallel_for(ready_.size(), context_,
                       [&](std::size_t i) { fill_in(ready_[i], graphs_[read_ + i]); });
    read_ += ready_.size();
  }

  void fill_in(cv::Mat& frame, const graph::AttributeGraph& graph) const {
    const cv::Mat seen = 255 - sketchable(graph, frame.size());
    if (cv::countNonZero(seen) == 0) return;  // nothing to diffuse from
    const cv::Mat levels = sketch::fill(core::to_levels(frame, info()), seen).levels;
    levels.convertTo(frame, frame.depth(), info().white / 255);
  }

  core::FrameSource& source_;
  Graphs graphs_;
  const core::Context& context_;
  std::vector<cv::Mat> ready_;
  std::size_t position_ = 0, read_ = 0;
};

double hidden_share(const dytex::Missing& missing) {
  if (!missing.any()) return 0;
  double hidden = 0;
  for (std::size_t t = 0; t < missing.frames(); ++t) hidden += static_cast<double>(missing.count(t));
  return hidden / (static_cast<double>(missing.frames()) * static_cast<double>(missing.pixels()));
}

void check_count(std::int64_t frames, std::size_t graphs) {
  if (frames < static_cast<std::int64_t>(fewest_frames))
    throw core::InputError("a texture needs at least " + std::to_string(fewest_frames) + " frames, not " +
                           std::to_string(frames));
  if (static_cast<std::size_t>(frames) != graphs)
    throw core::InputError("a clip of " + std::to_string(frames) + " frames has " + std::to_string(graphs) +
                           " graphs; it takes one for each frame");
}

}  // namespace

void BackgroundTextureOptions::validate() const {
  const auto refuse = [](const char* name, int value, const char* allowed) {
    throw core::InputError("GroundTextureOptions." + std::string(name) + " is " + std::to_string(value) +
                           ", allowed is " + allowed);
  };
  if (components < 1 || components > 500) refuse("components", components, "1 to 500");
  if (rounds < 0 || rounds > 100) refuse("rounds", rounds, "0 to 100");
}

BackgroundTexture learn_background_texture(core::FrameSource& source, Graphs graphs,
                                           const BackgroundTextureOptions& options,
                                           const core::Context& context) {
  options.validate();
  if (source.info().frames) check_count(*source.info().frames, graphs.size());
  if (graphs.size() < fewest_frames) check_count(static_cast<std::int64_t>(graphs.size()), graphs.size());
  BackgroundTexture result;
  std::optional<core::ClipRange> first;
  if (graphs.size() > most_frames) {
    result.notes.push_back("learned from the first " + std::to_string(most_frames) + " frames");
    graphs = graphs.first(most_frames);
    first.emplace(source, 0, static_cast<std::int64_t>(most_frames));
  }
  core::FrameSource& part = first ? static_cast<core::FrameSource&>(*first) : source;

  dytex::LearnOptions learning;
  learning.components = std::min(options.components, static_cast<int>(graphs.size() / 3));
  if (learning.components < options.components)
    result.notes.push_back(std::to_string(graphs.size()) + " frames give " +
                           std::to_string(learning.components) + " components");
  GroundSource ground(part, graphs, context);
  const auto learn = [&](core::FrameSource& seen) {
    auto learned = dytex::learn(seen, learning, context);
    return learned;
  };
  auto learned = learn(ground);
  MaskSource masks(graphs, part.info());
  const dytex::Missing missing(masks, part.info(), context);
  context.check();
  result.hidden = hidden_share(missing);
  for (int round = 0; round < options.rounds && result.hidden > 0; ++round) {
    dytex::FilledSource filled(part, missing, learned.texture);
    learned = learn(filled);
  }
  result.notes.insert(result.notes.end(), learned.notes.begin(), learned.notes.end());
  result.texture = std::move(learned.texture);
  return result;
}

}  // namespace emberfold::pipeline
