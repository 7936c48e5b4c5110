// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/builtin/scene.hpp"

namespace emberfold::apps {

/// What truly happens in a scene, as JSON: kind, width, height, frames, fps, noise, ramp (frames that a
/// change takes at most), flicker (of contrast), seed; `events` [{frame, type, x, y}],
/// by frame; and for each frame `strokes` [{id, polarity, sigma, ar, points}], every centre line (or piece of
/// one) that shows at half contrast or more, and `junctions` [[x, y]]: the ends of bridges and where strokes
/// cross.
std::string truth_of(const Scene& scene);

}  // namespace emberfold::apps
