// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/option_field.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// The rule that sets the number of components.
enum class Order {
  given,          ///< `components`, or `energy` where it is set
  gavish_donoho,  ///< singular values that stand out of white noise (Gavish, Donoho 2014)
  held_out        ///< the number that predicts the last fifth of the clip best, learned from the rest
};
/// The method that fits A.
enum class Method {
  closed_form,  ///< least squares
  n4sid         ///< stochastic subspaces (Van Overschee, De Moor 1993) of the states as measured
};
struct LearnOptions {
  int components = 50;  ///< n, at most τ − 1
  std::optional<double>
      energy{};  ///< (0, 1]: instead of n, the fewest components with this share of variance
  Order order = Order::given;
  Method method = Method::closed_form;
  /// n_v, 0 … n: numbers of v. B keeps this number of strongest directions of the fit's residuals; 0: all.
  int noise_rank = 0;
  /// bytes, ≥ 1 MiB: for frames held at a time; more passes where they do not fit. At least 256 pixels of
  /// every frame are held.
  std::size_t memory = std::size_t{1} << 30;

  /// Returns the description, for checks and help, of the field that several commands set.
  static auto fields() {
    using core::at_least;
    return std::to_array<core::OptionField<LearnOptions>>({
        {"components", &LearnOptions::components, "N", at_least(1),
         "Number of components of the linear dynamic texture, of all channels together"},
    });
  }
  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// The fit that the transition matrix came from.
enum class Transition { least_squares, yule_walker, n4sid };

struct LearnResult {
  LinearDynamicTexture texture;
  double least_squares_radius = 0;  ///< spectral radius of the least-squares A; at or above 1 it was replaced
  Transition transition = Transition::least_squares;
  int passes = 1;  ///< over the source
  /// Order::held_out: the squared error of predicting a value, levels², by the number of components.
  std::vector<std::pair<int, double>> held_out;
  std::vector<std::string> notes;  ///< a line for everything not as requested or measured
};

/// Learns a texture in closed form (Soatto, Doretto, Wu 2001, section 4; Doretto, Chiuso, Wu, Soatto 2003,
/// section 4.1): with Y the frames less their mean (m × τ) and Y = C S Vᵀ cut after n components, the states
/// are X = S Vᵀ, A is the least-squares fit of x(t+1) to x(t), B Bᵀ the covariance of its residuals, and r
/// the variance of the frames that n components do not show, (‖Y‖² − ‖X‖²) / ((m − n)(τ − 1 − n)). With
/// `noise_rank` B is the first columns of U S, the residuals' singular value decomposition. The decomposition
/// uses YᵀY = V S² Vᵀ (snapshots), which takes frames block by block.
///
/// Waves without noise (all poles of the least-squares A have the modulus 1, but for rounding) keep A,
/// brought to 1 − 1e-9, and get the noise that holds their covariance. Else, where the least-squares A is not
/// stable, or leaves no noise at all, A = Σ x(t+1) x(t)ᵀ S⁻² is used (Yule–Walker), with the noise that makes
/// the stationary covariance exactly the data's, S²/τ; a note says so, as one does where clips drawn from the
/// model would vary 1.5 times more or less than the clip. Frames of fewer independent directions than n give
/// fewer components, and a note.
///
/// The innovations form of n4sid takes X as measured with noise: the state of the model is (x(t), its
/// forecast from the frames before), N = 2n.
///
/// The source is read from its beginning: once if all frames fit in `memory`, else once for every block of
/// pixels that does, and once more. The same bytes at any thread count and any budget of memory. Throws
/// InputError where n is above τ − 1, where there are fewer than 2 or more than 5000 frames
/// (learn_by_blocks() takes more) or too few for the options, or where a value is not finite. O(m τ²) +
/// O(τ³).
LearnResult learn(core::FrameSource& source, const LearnOptions& options = {},
                  const core::Context& context = {});

}  // namespace emberfold::dytex
