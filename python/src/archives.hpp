// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include "core/model_archive.hpp"

namespace emberfold::python {

/// Returns a model as (text, {name: array}, {name: part}), which can be pickled.
pybind11::tuple to_state(const core::ModelArchive& archive);
/// Returns whether two models are the same in every bit.
bool equal(const core::ModelArchive& a, const core::ModelArchive& b);
/// Reads such a state.
core::ModelArchive to_archive(const pybind11::tuple& state);

}  // namespace emberfold::python
