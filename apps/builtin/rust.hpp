// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/builtin/builtin_clip.hpp"

namespace emberfold::apps {

/// Makes a procedural time-lapse of painted metal on which rust breaks through, spreads, darkens and cracks
/// the paint. All places change in the same way at different times, as quilting needs. `options.scene` is
/// ignored. The same options give the same bytes at any thread count. Throws core::Cancelled. O(pixels ·
/// frames), about 5 ms per frame of 320×240.
core::Clip make_rust(const BuiltinOptions& options, const core::Context& context = {});

}  // namespace emberfold::apps
