// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dytex/linear_dynamic_texture.hpp"

/// Editing a linear dynamic texture (Doretto, Soatto, "Editable dynamic textures", 2002 and CVPR 2003). An
/// edit is a value; a list of edits is applied in its order, each to the result of the ones before.
namespace emberfold::dytex {

/// Scales the phases of A's pairs of poles by `factor` (2003, eq. 4); their moduli, and real poles, stay. A
/// pair whose phase would pass π becomes 0, as in the paper: its part of the state is then white noise. −1
/// conjugates the eigenvectors, the paper's way back in time (eq. 5), which keeps the spectrum but not the
/// correlations: Reverse does.
struct Speed {
  double factor = 1;  ///< Ω, −3 … 3
};

/// Runs time `factor` times as fast: A becomes its power, so that lifetimes scale as phases do; a negative
/// real pole keeps its sign, its modulus takes the power. A whole factor shows every factor-th frame, so that
/// a phase beyond π wraps around. The noise becomes P − A' P A'ᵀ, which keeps the stationary covariance P;
/// where that is not positive (not every sampled process has a finer one) its negative part is cut. At 0 time
/// stops: a clip drawn shows one moment, but for values so near the middle between two levels that their
/// rounding changes.
struct Flow {
  double factor = 1;  ///< 0, or 0.01 … 100
};

/// Reverses time exactly: A becomes P Aᵀ P⁻¹ with the noise P − A' P A'ᵀ, P the stationary covariance, which
/// stays; the covariance over k frames becomes its transpose. Twice gives A and Q back.
struct Reverse {};

/// Scales the noise: Q becomes α Q (2003, eq. 6), and with it the stationary covariance P exactly α P: √α
/// times the amplitude.
struct Intensity {
  double factor = 1;  ///< α, 0 … 3
};

/// Multiplies the eigenvalues of Q by these factors, from the largest on. Further ones stay.
struct Directions {
  std::vector<double> factors;  ///< 0 … 3 each, at most N
};

/// Multiplies the weights of the paper's three groups (2003, eq. 3): components 1 to 5, 6 to 15 and from 16
/// on.
struct Scales {
  double coarse = 1, medium = 1, fine = 1;  ///< 0 … 10; the paper's go to 2

  bool operator==(const Scales&) const = default;
};

/// Multiplies the weights of the first components by these factors. Further ones stay.
struct Weights {
  std::vector<double> factors;  ///< 0 … 10 each, at most n
};

struct Edit {
  std::variant<Speed, Flow, Reverse, Intensity, Directions, Scales, Weights> what;
  /// Speed and Flow: Q is rescaled so that the variance of what is shown, tr W P W, stays. Without, B is
  /// unchanged.
  bool keep_contrast = true;
};

/// Throws InputError naming the edit, its value and what is allowed.
void validate(const Edit& edit);

struct EditResult {
  LinearDynamicTexture texture;
  int dropped = 0;                 ///< poles that Speed or Flow made 0
  std::vector<std::string> notes;  ///< a line for everything that was not done as requested
};

/// Applies the edits in their order. Mean, C, r, noise, states and singular are unchanged; every A' is
/// stable. A factor of 1 changes no bit. Poles too close to be separated (nearly defective A) are turned
/// together, by their mean phase. Throws InputError for edits that validate() refuses and lists that are too
/// long; NumericalError where a decomposition fails. O(N⁴) at worst, in practice O(N³); C is not touched.
EditResult edit(LinearDynamicTexture texture, std::span<const Edit> edits);

/// Returns the edits named after a picture in the paper's figures (2003, Fig. 2; 2002, Figs. 2 to 5):
/// turbulent, hazy, billowing, patchy (smoke), rough-sea, lake, rain (ocean), spray, frothy, spurty
/// (fountain), fire-coarse, fire-medium, fire-fine, fire-slow, fire-fast, fire-reversed. For most of them the
/// paper says which sliders go up or down; the numbers are chosen here, as it prints none. Throws InputError,
/// with all names, for another name.
std::vector<Edit> preset(std::string_view name);

struct PresetInfo {
  std::string_view name, about;
};
std::span<const PresetInfo> presets();

}  // namespace emberfold::dytex
