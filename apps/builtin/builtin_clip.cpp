// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/builtin_clip.hpp"

#include <sstream>

#include "apps/builtin/render.hpp"
#include "apps/builtin/scene.hpp"
#include "apps/builtin/truth.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::apps {

BuiltinScene builtin_scene(std::string_view name) {
  if (name == "fire") return BuiltinScene::fire;
  if (name == "cloth") return BuiltinScene::cloth;
  if (name == "river") return BuiltinScene::river;
  throw core::InputError(
      "there is no built-in clip \"" + std::string(name) +
      "\"; there are builtin:fire, builtin:cloth, builtin:river and, as a time-lapse, builtin:rust");
}

void BuiltinOptions::validate() const {
  core::check_range("BuiltinOptions.width", width, 64, 4096);
  core::check_range("BuiltinOptions.height", height, 64, 4096);
  core::check_range("BuiltinOptions.frames", frames, 2, 10000);
  core::check_range("BuiltinOptions.fps", fps, 0.001, 1000);
  constexpr double most = 2147483648.0;
  const double bytes = 3.0 * width * height * frames;
  if (bytes > most) {
    std::ostringstream line;
    line << "built-in clip: " << frames << " frames of " << width << "x" << height << " pixels would take "
         << bytes / (1 << 20) << " MiB; at most 2048 are allowed";
    throw core::InputError(line.str());
  }
}

BuiltinClip make_builtin(const BuiltinOptions& options, const core::Context& context) {
  options.validate();
  const Scene scene = plan_scene(options);
  BuiltinClip made;
  made.clip.info = {.width = options.width,
                    .height = options.height,
                    .channels = 3,
                    .depth = CV_8U,
                    .fps = options.fps,
                    .white = 255,
                    .frames = options.frames};
  made.clip.frames.resize(static_cast<std::size_t>(options.frames));
  core::parallel_for(made.clip.frames.size(), context,
                     [&](std::size_t t) { made.clip.frames[t] = render_frame(scene, static_cast<int>(t)); });
  made.truth_json = truth_of(scene);
  return made;
}

}  // namespace emberfold::apps
