// SPDX-License-Identifier: Apache-2.0
// For the sketch library's own sources; not installed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sketch/inpainting/multigrid.hpp"

namespace emberfold::sketch {

/// Solves Laplace's equation with some pixels held, or (Δ − sink) u = 0. Conjugate gradients run on the black
/// pixels of a chequerboard alone: the red ones, whose neighbours are all black, are eliminated exactly,
/// which halves every vector and the number of sweeps. One object serves all channels of a frame.
template <class Real>
class Diffusion {
 public:
  /// Prepares the solver. `held`: rows of `width` bytes, not 0 where a pixel is held. `sink` ≥ 0: conductance
  /// from every other pixel to 0; a link to a neighbour has 1.
  Diffusion(int width, int height, const std::vector<const std::uint8_t*>& held, Real sink = 0);

  /// Holds how a solve ended.
  struct Outcome {
    int iterations = 0;
    double error = 0;  ///< estimate of the largest error left, in the field's unit
    bool converged = false;
  };
  /// Solves for the pixels that are not held. `field`: the values of the held pixels, 0 elsewhere. Stops when
  /// the estimated error is at most `tolerance` everywhere.
  Outcome solve(Board<Real>& field, double tolerance, int max_iterations);

  /// Returns one row of cells, for the caller's use between calls.
  std::vector<Real>& row() { return cells_; }

 private:
  /// Holds r·M⁻¹r and max |M⁻¹r| after one application of the preconditioner.
  struct Correction {
    double product, largest;
  };

  Real* lane(int y) { return ring_[static_cast<std::size_t>(y & 3)].data() + 8; }
  Level<Real> first_level(const Board<Real>& diagonal);
  void average(Board<Real>& field, int colour) const;
  void begin(Board<Real>& field);
  Correction precondition();
  void descend();
  Correction ascend();
  void lift(int y);
  double search(Real beta);
  void eliminate(int y);
  void advance(Board<Real>& field, Real alpha);

  int width_, height_, span_;
  Board<Real> unknown_;              // 1 where a pixel is to be solved for, else 0
  Board<Real> inverse_;              // 1/(number of neighbours + sink) there, else 0
  Half<Real> diagonal_;              // number of neighbours + sink of the black unknowns
  std::vector<Level<Real>> levels_;  // from the 2×2 blocks on
  Half<Real> r_, z_, p_, q_;         // residual, M⁻¹ r, search direction, A p, all of the black pixels
  std::array<std::vector<Real>, 4> ring_;  // the red rows in use
  std::vector<Real> cells_;
};

}  // namespace emberfold::sketch
