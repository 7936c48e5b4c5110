// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/benchmark/line_scene.hpp"
#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

/// Names the kinds of synthetic scenes.
/// strokes: the built-in cloth. flames: tongues whose tips break off and rise, and arms that appear and
/// disappear. folds: parallel lines 12 to 16 px apart, alternately bright and dark, that break and close.
/// ripples: rings that are born, grow until they touch, separate and die. networks: trees that edges join and
/// split. filaments: lines that drift, touch and cross, which are no events. sway: a picture that moves to
/// and fro, without events.
enum class SceneKind : std::uint8_t { strokes, flames, folds, ripples, networks, filaments, sway };
/// Returns all kinds in the order of their values.
std::vector<SceneKind> all_scene_kinds();
/// Returns the name of a kind.
std::string_view name(SceneKind kind);
/// Returns the kind of this name, if there is one.
std::optional<SceneKind> scene_kind(std::string_view name);

/// Options of a synthetic scene.
struct SceneOptions {
  std::uint64_t seed = 1;
  int frames = 100;  ///< 60…1000
  cv::Mat picture;   ///< the picture of `sway`, CV_8UC1 or CV_8UC3; empty: a drawn one (builtin:rust)
  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// A synthetic clip and its true events.
struct MadeScene {
  core::Clip clip;
  std::vector<graph::Event> truth;  ///< sorted
};

/// Lays out the lines of a scene and their events. Throws InputError for options out of range, and for
/// strokes and sway, which have no such lines.
LineScene plan_line_scene(SceneKind kind, const SceneOptions& options);

/// Makes a scene of 320 × 240 px (a picture: 320 px wide). Equal options give the same bytes at any number of
/// threads. Throws InputError as validate() does, core::Cancelled.
MadeScene make_scene(SceneKind kind, const SceneOptions& options, const core::Context& context = {});

}  // namespace emberfold::apps
