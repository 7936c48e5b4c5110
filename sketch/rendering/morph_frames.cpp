// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/morph_frames.hpp"

#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::sketch {

void draw_morph(const graph::Morph& morph, const MorphLook& look,
                const std::function<void(const cv::Mat&)>& take, const core::Context& context) {
  constexpr std::size_t kAtOnce = 8;
  const auto& sketch = morph.motion.sketch;
  const std::size_t count = sketch.frames.size();
  std::vector<cv::Mat> drawn(kAtOnce);
  const auto draw = [&](std::size_t t) {
    RenderOptions options{.size = {sketch.width, sketch.height}, .channels = look.channels};
    options.empty_level = std::lerp(look.level_from, look.level_to,
                                    count > 1 ? static_cast<float>(t) / static_cast<float>(count - 1) : 0.0F);
    FrameContent content{sketch.frames[t]};
    content.opacity = morph.opacity[t];
    drawn[t % kAtOnce] = render_frame(content, options);
  };
  const auto pass_on = [&](std::size_t t) {
    take(drawn[t % kAtOnce]);
    context.report("draw", (static_cast<double>(t) + 1) / static_cast<double>(count));
  };
  core::parallel_stream(count, kAtOnce, context, {[](std::size_t) {}, draw, pass_on});
}

}  // namespace emberfold::sketch
