// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::apps {

enum class BuiltinScene { fire, cloth, river };

/// The scene of that name ("fire", "cloth", "river"); core::InputError, telling which there are, for another.
BuiltinScene builtin_scene(std::string_view name);

struct BuiltinOptions {
  BuiltinScene scene = BuiltinScene::fire;
  std::uint64_t seed = 1;
  int width = 320;   ///< px, 64…4096
  int height = 240;  ///< px, 64…4096
  int frames = 120;  ///< 2…10000; width × height × frames × 3 at most 2^31 bytes
  double fps = 25;   ///< 0.001…1000

  /// core::InputError naming field, value and range.
  void validate() const;
};

struct BuiltinClip {
  core::Clip clip;         ///< CV_8UC3
  std::string truth_json;  ///< what truly happens in it
};

/// A procedural clip with exactly known events; the same bytes for the same options at any thread count.
/// Checks the options before memory is taken. A cancelled call returns no frames and no truth. Cost: some 10
/// ms a frame of 320×240, on all threads.
BuiltinClip make_builtin(const BuiltinOptions& options, const core::Context& context = {});

}  // namespace emberfold::apps
