// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/em.hpp"

#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"
#include "dytex/estimation/em_appearance.hpp"
#include "dytex/estimation/em_dynamics.hpp"
#include "dytex/estimation/observations.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/dynamics.hpp"
#include "dytex/learning/frame_blocks.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBlocks;
using detail::FrameValues;

[[noreturn]] void fail_likelihood(const std::string& what) {
  throw core::InputError("maximise_likelihood: " + what);
}

void check_start(const LinearDynamicTexture& start, const core::ClipInfo& info) {
  validate(start);
  if (info.width != start.info.width || info.height != start.info.height ||
      info.channels != start.info.channels)
    fail_likelihood("the start is " + core::size_text(start.info.width, start.info.height) + " of " +
                    std::to_string(start.info.channels) + " channels, the clip " +
                    core::size_text(info.width, info.height) + " of " + std::to_string(info.channels));
  if (start.order() != start.components())
    fail_likelihood("the start has states of " + std::to_string(start.order()) + " numbers for " +
                    std::to_string(start.components()) +
                    " components; models in closed form alone can be improved");
  if ((start.weights.array() != 1).any())
    fail_likelihood("the start was edited; a model as it was learned is needed");
}

/// Current state of EM.
struct Fit {
  StateSpace space;
  Smoothed smoothed;
};

/// Iterates from the start; the smoothed states are those of the last parameters.
void iterate(detail::Appearance& appearance, const EmOptions& options, const core::Context& context, Fit& fit,
             EmResult& result) {
  Observations seen = appearance.observe();
  for (int i = 0;; ++i) {
    const Filtered filtered = filter(fit.space, seen);
    fit.smoothed = smooth(fit.space, filtered);
    const double now = filtered.log_likelihood;
    const double gain = i > 0 ? now - result.log_likelihood.back() : 0;
    result.log_likelihood.push_back(now);
    context.report("maximising likelihood", static_cast<double>(i) / options.iterations);
    result.converged = i > 0 && gain <= options.tolerance * std::abs(now);
    if (result.converged || i == options.iterations) return;
    fit.space = detail::maximise_dynamics(fit.smoothed);
    context.check();
    seen = appearance.maximise(fit.smoothed);
  }
}

/// The basis in which C is orthonormal and the states' variances fall: x ← T x, C ← C T⁻¹.
struct Basis {
  Eigen::MatrixXd T, inverse;
};
Basis state_basis(const Eigen::MatrixXd& products, const Eigen::MatrixXd& states) {
  if (products.size() == 0) return {products, products};
  const detail::CholeskyFactors factors(products);
  if (!factors.positive())
    throw core::NumericalError("maximise_likelihood: the components are no longer independent");
  const Eigen::MatrixXd right = factors.upper();
  const Eigen::MatrixXd turned = right * states;
  const Eigen::MatrixXd U = detail::symmetric_eigen(turned * turned.transpose()).vectors;
  return {U.transpose() * right, factors.solve_upper(U)};
}

void take_dynamics(const Fit& fit, const Basis& basis, EmResult& result) {
  LinearDynamicTexture& texture = result.texture;
  const auto take = [&](const StateSpace& space) {
    texture.A = basis.T * space.A * basis.inverse;
    texture.B = basis.T * space.B;
  };
  take(fit.space);
  const double radius = spectral_radius(texture.A);
  if (radius < 1) return;
  take(detail::stable_dynamics(fit.smoothed));
  result.notes.push_back("the most likely A is not stable (spectral radius " +
                         core::significant_text(radius, 6) +
                         "): the Yule-Walker fit to the smoothed states is taken");
}

/// Finds all singular values of the centred frames, with hidden values as the texture shows them.
void filled_spectrum(core::FrameSource& source, const Missing& missing, const EmOptions& options,
                     const core::Context& context, EmResult& result) {
  LinearDynamicTexture& texture = result.texture;
  FilledSource filled(source, missing, texture);
  FrameBlocks frame_blocks(filled, options.memory, detail::kMostFrames, context);
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(frames, frames);
  const auto add = [&](std::size_t, const FrameValues& values) { detail::add_gram(values, gram, context); };
  frame_blocks.for_each("comparing frames", false, add, context);
  result.passes += frame_blocks.passes();
  texture.singular = detail::symmetric_eigen(detail::centred(gram)).values.cwiseMax(0).cwiseSqrt() *
                     (255 / source.info().white);
}

/// Notes where clips drawn from the model vary much more or less than the smoothed states.
void compare_variance(EmResult& result) {
  const LinearDynamicTexture& texture = result.texture;
  const double drawn = stationary_covariance(texture.A, texture.B).trace();
  const double seen = texture.states.squaredNorm() / static_cast<double>(texture.states.cols());
  if (const auto note = detail::variance_note(drawn, seen)) result.notes.push_back(*note);
}

void finish(detail::Appearance& appearance, const Fit& fit, const core::ClipInfo& info, EmResult& result) {
  LinearDynamicTexture& texture = result.texture;
  const Basis basis = state_basis(appearance.products(), fit.smoothed.states);
  texture.info = info;
  texture.info.frames = fit.smoothed.states.cols();
  take_dynamics(fit, basis, result);
  texture.states = basis.T * fit.smoothed.states;
  texture.weights = Eigen::VectorXd::Ones(texture.A.rows());
  appearance.write(basis.inverse, texture);
  result.likelihood_r = appearance.r();
  const double correction = appearance.r_correction();
  texture.r *= correction;
  texture.noise *= static_cast<float>(correction);
  compare_variance(result);
  for (std::string& note : appearance.notes()) result.notes.push_back(std::move(note));
}

}  // namespace

void EmOptions::validate() const {
  core::check_range("EmOptions.iterations", iterations, 1, 100000);
  core::check_range("EmOptions.tolerance", tolerance, 0, 1);
  core::check_above("EmOptions.least_noise", least_noise, 0);
  core::check_at_least("EmOptions.memory", static_cast<double>(memory), detail::kLeastMemory);
}

EmResult maximise_likelihood(core::FrameSource& source, const LinearDynamicTexture& start,
                             const EmOptions& options, const Missing& missing, const core::Context& context) {
  options.validate();
  check_start(start, source.info());
  FrameBlocks frame_blocks(source, options.memory, detail::kMostFrames, context);
  missing.check_frames(frame_blocks.frames());
  if (static_cast<Eigen::Index>(frame_blocks.frames()) != start.states.cols())
    fail_likelihood("the start was learned from " + std::to_string(start.states.cols()) +
                    " frames, the clip has " + std::to_string(frame_blocks.frames()));
  EmResult result;
  if (start.noise_share < 1)
    result.notes.emplace_back("the likelihood is of noise in all directions: the start's fewer are left");
  if (start.components() == 0) {
    result.notes.emplace_back("the frames do not change: there is nothing to improve");
    result.texture = start;
    result.converged = true;
    result.likelihood_r = start.r;
    result.passes = frame_blocks.passes();
    return result;
  }
  const detail::AppearanceInput input{
      frame_blocks, missing, start,
      options,      context, {255 / source.info().white, static_cast<std::size_t>(source.info().channels)}};
  const bool by_gram = !options.noise_per_value && missing.by_frames();
  const auto appearance = by_gram ? detail::gram_appearance(input) : detail::value_appearance(input);
  Fit fit{state_space(start), {}};
  iterate(*appearance, options, context, fit, result);
  finish(*appearance, fit, source.info(), result);
  result.passes += frame_blocks.passes();
  if (missing.any())
    filled_spectrum(source, missing, options, context, result);
  else
    result.texture.singular = start.singular;
  return result;
}

EmResult learn_missing(core::FrameSource& source, const Missing& missing, const LearnOptions& learning,
                       const EmOptions& options, const core::Context& context) {
  learning.validate();
  options.validate();
  HeldSource held(source, missing, context);
  const LearnResult start = learn(held, learning, context);
  EmResult result = maximise_likelihood(source, start.texture, options, missing, context);
  result.passes += start.passes + 1;
  std::vector<std::string> notes;  // the start's own describe a model that was replaced
  if (start.texture.components() < learning.components && !learning.energy)
    notes.push_back("what is seen changes in " + std::to_string(start.texture.components()) +
                    " directions only: the model has as many components");
  if (held.never_seen() > 0)
    notes.push_back(
        std::to_string(held.never_seen()) + (held.never_seen() == 1 ? " pixel is" : " pixels are") +
        " hidden in every frame: nothing is known of " + (held.never_seen() == 1 ? "it" : "them"));
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  return result;
}

}  // namespace emberfold::dytex
