// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/context.hpp"
#include "graph/morphing/morph.hpp"
#include "graph/morphing/stroke_path.hpp"

namespace emberfold::graph::detail {

/// The curves of two graphs, paired.
struct CurvePairs {
  std::vector<StrokePath> paths;                ///< of the pairs
  std::vector<SampledCurve> dying, being_born;  ///< curves without partner
  double length = 0;                            ///< px, as Morph::length
};

/// Pairs the curves of two graphs so that Morph::length is least. Errors as for morph().
CurvePairs pair_curves(const AttributeGraph& from, const AttributeGraph& to, const core::Context& context);

}  // namespace emberfold::graph::detail
