// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/open_clip.hpp"

#include <string_view>
#include <utility>

#include "apps/builtin/builtin_clip.hpp"
#include "apps/builtin/rust.hpp"
#include "core/clip/masked_source.hpp"

namespace emberfold::apps {

std::unique_ptr<core::FrameSource> open_clip(const std::string& name, const io::ReadOptions& options,
                                             const core::Warn& warn) {
  constexpr std::string_view kPrefix = "builtin:";
  if (!name.starts_with(kPrefix)) return io::open_video(name, options, warn);
  options.validate();
  BuiltinOptions scene;
  scene.seed = options.seed;
  if (name == "builtin:rust") return io::open_clip(make_rust(scene), name, options, warn);
  scene.scene = builtin_scene(name.substr(kPrefix.size()));
  return io::open_clip(make_builtin(scene).clip, name, options, warn);
}

std::unique_ptr<core::FrameSource> open_clip(const std::string& name, const io::ReadOptions& options,
                                             Session& session) {
  return open_clip(name, options, [&session](const std::string& text) { session.warn(text); });
}

std::unique_ptr<core::FrameSource> open_held_clip(const std::string& name, const io::ReadOptions& options,
                                                  const core::Warn& warn) {
  auto clip = open_clip(name, options, warn);
  if (options.mask.empty() && options.stabilize == io::Stabilize::none) return clip;
  return std::make_unique<core::HeldOutside>(std::move(clip));
}

std::unique_ptr<core::FrameSource> open_held_clip(const std::string& name, const io::ReadOptions& options,
                                                  Session& session) {
  return open_held_clip(name, options, [&session](const std::string& text) { session.warn(text); });
}

}  // namespace emberfold::apps
