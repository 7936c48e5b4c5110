// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "graph/events/review.hpp"
#include "python/src/holders.hpp"

namespace emberfold::python {

/// Returns a reviewed event as (frame, type, x, y, probability, before, after, answer): the answer is None,
/// "yes", "no", "added" or another class, as in review.json.
pybind11::tuple review_tuple(const graph::ReviewedEvent& reviewed);
/// Reads such a tuple. ValueError for another answer or class.
graph::ReviewedEvent to_review(const pybind11::tuple& row);

}  // namespace emberfold::python

namespace pybind11::detail {

template <>
struct type_caster<emberfold::graph::ReviewedEvent> {
  PYBIND11_TYPE_CASTER(emberfold::graph::ReviewedEvent, const_name("Tuple[Any, ...]"));
  bool load(handle source, bool) {
    if (!isinstance<tuple>(source) || pybind11::len(source) != 8) return false;
    value = emberfold::python::to_review(reinterpret_borrow<tuple>(source));
    return true;
  }
  static handle cast(const emberfold::graph::ReviewedEvent& reviewed, return_value_policy, handle) {
    return emberfold::python::review_tuple(reviewed).release();
  }
};

}  // namespace pybind11::detail
