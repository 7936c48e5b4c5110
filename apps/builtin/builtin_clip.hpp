// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::apps {

enum class BuiltinScene { fire, cloth, river };

/// Returns the scene named "fire", "cloth" or "river". Throws core::InputError for another name.
BuiltinScene builtin_scene(std::string_view name);

/// Options of a built-in clip.
struct BuiltinOptions {
  BuiltinScene scene = BuiltinScene::fire;
  std::uint64_t seed = 1;
  int width = 320;   ///< px, 64…4096
  int height = 240;  ///< px, 64…4096
  int frames = 120;  ///< 2…10000; width × height × frames × 3 at most 2^31 bytes
  double fps = 25;   ///< 0.001…1000

  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// A built-in clip and its true events.
struct BuiltinClip {
  core::Clip clip;         ///< CV_8UC3
  std::string truth_json;  ///< as truth_of() writes it
};

/// Makes a procedural clip with exactly known events. The same options give the same bytes at any thread
/// count. Checks the options before allocating memory. Throws core::Cancelled. Cost: about 10 ms per frame of
/// 320×240.
BuiltinClip make_builtin(const BuiltinOptions& options, const core::Context& context = {});

}  // namespace emberfold::apps
