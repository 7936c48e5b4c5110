// SPDX-License-Identifier: Apache-2.0
#include "pipeline/texture/texture_synthesis.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/learn_by_blocks.hpp"

namespace emberfold::pipeline {

TextureSynthesis::TextureSynthesis(std::vector<cv::Mat> footage, std::uint64_t seed) : seed_(seed) {
  if (footage.size() < 2) throw core::InputError("a texture is learned from two frames or more");
  const auto& frame = footage.front();
  auto& info = footage_.info;
  info.width = frame.cols, info.height = frame.rows, info.channels = frame.channels();
  info.frames = static_cast<std::int64_t>(footage.size());
  footage_.frames = std::move(footage);
}

void TextureSynthesis::learn(const core::Context& context) {
  dytex::LearnOptions options;
  options.components = std::min(options.components, static_cast<int>(footage_.frames.size()) - 1);
  core::ClipSource source(footage_);
  auto learned = dytex::needs_blocks(footage_.info) ? dytex::learn_by_blocks(source, options, 0, context)
                                                    : dytex::learn(source, options, context);
  for (const auto& note : learned.notes) context.warn(note);
  texture_ = std::make_unique<const dytex::LinearDynamicTexture>(std::move(learned.texture));
  synthesis_.emplace(*texture_, dytex::SynthesisOptions{.seed = seed_, .first_frame = {}});
  footage_.frames.clear();
}

void TextureSynthesis::each(int count, const std::function<void(cv::Mat)>& take,
                            const core::Context& context) {
  if (!synthesis_) learn(context);
  for (int n = 0; n < count; ++n) {
    context.check();
    take(synthesis_->next());
  }
}

graph::MotionGraph TextureSynthesis::motion(int /*count*/, const core::Context& /*context*/) const {
  throw core::InputError("a texture draws no strokes");
}

}  // namespace emberfold::pipeline
