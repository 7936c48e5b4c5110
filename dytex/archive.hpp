// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/model_archive.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// The format "emberfold.linear_dynamic_texture", version 1: what is not an array in model.json; arrays mean
/// (m), C (m × n) in single precision, A (n × n), B (n × k), states (n × τ) and singular (τ) in double.
/// InputError where the texture is not valid. Reading the archive gives the same texture, bit for bit.
core::ModelArchive to_archive(const LinearDynamicTexture& texture);

/// Throws core::IoError, naming the key or array, its value and what is expected, for a text that is no JSON,
/// another format, a newer version, a missing key or array, an array of another type or shape, and anything
/// that validate() refuses. Sizes are checked before memory is taken. Arrays may lie in either order.
LinearDynamicTexture linear_dynamic_texture(const core::ModelArchive& archive);

}  // namespace emberfold::dytex
