// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/builtin/scene.hpp"

namespace emberfold::apps {

/// Writes the true events and strokes of a scene as JSON. Fields: kind, width, height, frames, fps, noise,
/// ramp (maximum frames of a change), flicker (of contrast), seed; `events` [{frame, type, x, y}] by frame;
/// for each frame `strokes` [{id, polarity, sigma, ar, points}], the centre lines or pieces of them at half
/// contrast or more, and `junctions` [[x, y]]: ends of bridges and crossings.
std::string truth_of(const Scene& scene);

}  // namespace emberfold::apps
