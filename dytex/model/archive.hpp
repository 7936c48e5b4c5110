// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/model_archive.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// Makes an archive of the format "emberfold.linear_dynamic_texture", version 2. Numbers are in model.json.
/// Arrays: mean (m), C (m × n) in single precision, weights (n), A (N × N), B (N × k), states (N × τ) and
/// singular (τ) in double; noise (m, single) where there is any. InputError where the texture is not valid.
/// Reading the archive gives the same texture, bit for bit.
core::ModelArchive to_archive(const LinearDynamicTexture& texture);
/// Makes a view of that archive without a copy of the arrays. The texture must outlive the view.
core::ModelView archive_view(const LinearDynamicTexture& texture);
core::ModelView archive_view(LinearDynamicTexture&&) = delete;

/// Reads a texture from an archive. Throws core::IoError, naming the key or array, its value and what is
/// expected, for a text that is not JSON, another format, a newer version, a missing key or array, an array
/// of another type or shape, and anything that validate() refuses. Version 1 had neither weights (ones) nor
/// the optional arrays. mean and C may be in float16 or uint8 too (compression.hpp). Sizes are checked before
/// memory is taken. Arrays may be stored in either order.
LinearDynamicTexture linear_dynamic_texture(const core::ModelArchive& archive);

}  // namespace emberfold::dytex
