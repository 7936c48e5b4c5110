// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "dytex/linear_dynamic_texture.hpp"

/// A texture as a compressed clip (Soatto, Doretto, Wu 2001, section 4.5): its size and its error.
namespace emberfold::dytex {

/// The number format of mean and C, which are nearly all of a model. u8: C in 256 steps from the least to the
/// largest value of each column, C = C_offset + C_scale · C.npy; the mean in f16.
enum class Precision { f32, f16, u8 };
constexpr Precision kPrecisions[] = {Precision::f32, Precision::f16, Precision::u8};
/// Returns "f32", "f16" or "u8".
const char* name(Precision precision);
std::optional<Precision> precision_of(std::string_view name);

/// Makes the archive of a texture with mean and C in a number format; see archive.hpp.
/// linear_dynamic_texture() reads all three; f32 is exact, the others give C to 2⁻¹² of a value or 1/510 of a
/// column's range. InputError where the mean leaves f16's range, ±65504.
core::ModelArchive to_archive(const LinearDynamicTexture& texture, Precision precision);

/// Returns the texture as read again from an archive of this precision.
LinearDynamicTexture rounded(const LinearDynamicTexture& texture, Precision precision);

/// Counts the bytes of all arrays of a model of `components` of the texture's. The files have 128 more each,
/// and model.json some hundreds. InputError where components is not 0 … n.
std::size_t stored_bytes(const LinearDynamicTexture& texture, Eigen::Index components, Precision precision);

/// Returns the mean square error of the training frames projected onto the first 0, 1, … n components of
/// rounded(texture, precision): n + 1 numbers, levels² a value, falling. From the model alone, O(m n²): exact
/// up to rounding for models learned in closed form, whose states are CᵀY.
Eigen::VectorXd projection_errors(const LinearDynamicTexture& texture, Precision precision);

/// Measures the mean square error of frames of `source` projected onto all components of `texture`, drawn and
/// rounded to 8 bits; levels² a value. Components count without weights. Throws InputError where frames are
/// of another size or channels, or their number is not that of the training frames. O(m n) a frame.
double measured_error(const LinearDynamicTexture& texture, core::FrameSource& source,
                      const core::Context& context = {});

}  // namespace emberfold::dytex
