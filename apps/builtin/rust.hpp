// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/builtin/builtin_clip.hpp"

namespace emberfold::apps {

/// A procedural time-lapse: painted metal on which rust breaks through in spots, spreads with ragged edges,
/// darkens with age and lets the paint crack. Every place fares alike, whatever its own course: what quilting
/// needs. `options.scene` is not read. The same bytes for the same options at any thread count; cancelled:
/// no frames. O(pixels · frames) after laying out, some 5 ms a frame of 320×240.
core::Clip make_rust(const BuiltinOptions& options, const core::Context& context = {});

}  // namespace emberfold::apps
