// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/em.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include <Eigen/Cholesky>

#include "core/error.hpp"
#include "dytex/estimation/em_appearance.hpp"
#include "dytex/estimation/em_dynamics.hpp"
#include "dytex/estimation/observations.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/frame_blocks.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBands;
using detail::FrameValues;

constexpr std::size_t kMostFrames = 5000;  // as learn()

[[noreturn]] void fail(const std::string& what) {
  throw core::InputError("maximise_likelihood: " + what);
}

void check_start(const LinearDynamicTexture& start, const core::ClipInfo& info) {
  validate(start);
  if (info.width != start.info.width || info.height != start.info.height ||
      info.channels != start.info.channels)
    fail("the start is " + std::to_string(start.info.width) + "x" + std::to_string(start.info.height) +
         " of " + std::to_string(start.info.channels) + " channels, the clip " + std::to_string(info.width) +
         "x" + std::to_string(info.height) + " of " + std::to_string(info.channels));
  if (start.order() != start.components())
    fail("the start has states of " + std::to_string(start.order()) + " numbers for " +
         std::to_string(start.components()) + " components; models of lag 1 alone can be improved");
  if (start.channels.size() > 0) fail("the start is a model per channel; one of all channels is needed");
  if ((start.weights.array() != 1).any()) fail("the start was edited; a model as it was learned is needed");
}

/// Where EM stands.
struct Fit {
  StateSpace space;
  Smoothed smoothed;
};

/// From the start to the last iteration; the smoothed states are those of the last parameters.
core::Status iterate(detail::Appearance& appearance, const EmOptions& options, const core::Context& context,
                     Fit& fit, EmResult& result) {
  Observations seen;
  if (appearance.observe(seen) == core::Status::cancelled) return core::Status::cancelled;
  for (int i = 0;; ++i) {
    const Filtered filtered = filter(fit.space, seen);
    fit.smoothed = smooth(fit.space, filtered);
    const double now = filtered.log_likelihood;
    const double gain = i > 0 ? now - result.log_likelihood.back() : 0;
    result.log_likelihood.push_back(now);
    context.report("maximising likelihood", static_cast<double>(i) / options.iterations);
    result.converged = i > 0 && gain <= options.tolerance * std::abs(now);
    if (result.converged || i == options.iterations) return core::Status::done;
    fit.space = detail::maximise_dynamics(fit.smoothed);
    if (context.cancelled() || appearance.maximise(fit.smoothed, seen) == core::Status::cancelled)
      return core::Status::cancelled;
  }
}

/// The basis in which C is orthonormal and the states' variances fall: x ← T x, C ← C T⁻¹.
struct Basis {
  Eigen::MatrixXd T, inverse;
};
Basis state_basis(const Eigen::MatrixXd& products, const Eigen::MatrixXd& states) {
  if (products.size() == 0) return {products, products};
  const Eigen::LLT<Eigen::MatrixXd> cholesky(products);
  if (cholesky.info() != Eigen::Success)
    throw core::NumericalError("maximise_likelihood: the components are no longer independent");
  const Eigen::MatrixXd right = cholesky.matrixU();
  const Eigen::MatrixXd turned = right * states;
  const Eigen::MatrixXd U = detail::symmetric_eigen(turned * turned.transpose()).vectors;
  return {U.transpose() * right, cholesky.matrixU().solve(U)};
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
  std::ostringstream text;
  text << "the most likely A is not stable (spectral radius " << radius
       << "): the Yule-Walker fit to the smoothed states is taken";
  result.notes.push_back(text.str());
}

/// All singular values of the centred frames, with what is hidden as the texture shows it.
core::Status filled_spectrum(core::FrameSource& source, const Missing& missing, const EmOptions& options,
                             const core::Context& context, EmResult& result) {
  LinearDynamicTexture& texture = result.texture;
  FilledSource filled(source, missing, texture);
  FrameBands bands(filled, options.memory, kMostFrames, context);
  if (bands.frames() == 0) return core::Status::cancelled;
  const auto frames = static_cast<Eigen::Index>(bands.frames());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(frames, frames);
  const auto add = [&](std::size_t, const FrameValues& values) {
    return detail::add_gram(values, gram, context);
  };
  if (bands.for_each("comparing frames", false, add, context) == core::Status::cancelled)
    return core::Status::cancelled;
  result.passes += bands.passes();
  texture.singular = detail::symmetric_eigen(detail::centred(gram)).values.cwiseMax(0).cwiseSqrt() *
                     (255 / source.info().white);
  return core::Status::done;
}

void tell_start(const LinearDynamicTexture& start, EmResult& result) {
  if (start.residuals.size() > 0)
    result.notes.emplace_back("likelihood is of Gaussian noise: the start's residuals are left out");
}

/// Says where clips drawn from the model vary much more or less than the smoothed states.
void compare_variance(EmResult& result) {
  constexpr double kMuch = 1.5;
  const LinearDynamicTexture& texture = result.texture;
  const double drawn = stationary_covariance(texture.A, texture.B).trace();
  const double seen = texture.states.squaredNorm() / static_cast<double>(texture.states.cols());
  if (drawn <= kMuch * seen && seen <= kMuch * drawn) return;
  std::ostringstream text;
  text.precision(2);
  text << "clips drawn from the model have " << drawn / seen
       << " times the variance of the clip it was learned from";
  result.notes.push_back(text.str());
}

core::Status finish(detail::Appearance& appearance, const Fit& fit, const core::ClipInfo& info,
                    EmResult& result) {
  LinearDynamicTexture& texture = result.texture;
  const Basis basis = state_basis(appearance.products(), fit.smoothed.states);
  texture.info = info;
  texture.info.frames = fit.smoothed.states.cols();
  take_dynamics(fit, basis, result);
  texture.states = basis.T * fit.smoothed.states;
  texture.weights = Eigen::VectorXd::Ones(texture.A.rows());
  if (appearance.write(basis.inverse, texture) == core::Status::cancelled) return core::Status::cancelled;
  result.likelihood_r = appearance.r();
  const double correction = appearance.r_correction();
  texture.r *= correction;
  texture.noise *= static_cast<float>(correction);
  compare_variance(result);
  for (std::string& note : appearance.notes()) result.notes.push_back(std::move(note));
  return core::Status::done;
}

}  // namespace

void EmOptions::validate() const {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    std::ostringstream text;
    text << name << " is " << value << ", " << allowed;
    throw core::InputError(text.str());
  };
  if (iterations < 1 || iterations > 100000) refuse("iterations", iterations, "allowed is 1 to 100000");
  if (!(tolerance >= 0 && tolerance <= 1)) refuse("tolerance", tolerance, "allowed is 0 to 1");
  if (!(least_noise > 0) || !std::isfinite(least_noise))
    refuse("least_noise", least_noise, "must be positive and finite");
  if (memory < std::size_t{1} << 20)
    throw core::InputError("memory is " + std::to_string(memory) + " bytes, must be at least 1048576");
}

EmResult maximise_likelihood(core::FrameSource& source, const LinearDynamicTexture& start,
                             const EmOptions& options, const Missing& missing, const core::Context& context) {
  options.validate();
  check_start(start, source.info());
  FrameBands bands(source, options.memory, kMostFrames, context);
  if (bands.frames() == 0) throw core::Cancelled{};
  missing.check_frames(bands.frames());
  if (static_cast<Eigen::Index>(bands.frames()) != start.states.cols())
    fail("the start was learned from " + std::to_string(start.states.cols()) + " frames, the clip has " +
         std::to_string(bands.frames()));
  EmResult result;
  tell_start(start, result);
  if (start.components() == 0) {
    result.notes.emplace_back("the frames do not change: there is nothing to improve");
    result.texture = start;
    result.converged = true;
    result.likelihood_r = start.r;
    result.passes = bands.passes();
    return result;
  }
  const detail::AppearanceInput input{
      bands,   missing, start,
      options, context, {255 / source.info().white, static_cast<std::size_t>(source.info().channels)}};
  const bool by_gram = !options.noise_per_value && missing.by_frames();
  const auto appearance = by_gram ? detail::gram_appearance(input) : detail::value_appearance(input);
  Fit fit{state_space(start), {}};
  if (iterate(*appearance, options, context, fit, result) == core::Status::cancelled ||
      finish(*appearance, fit, source.info(), result) == core::Status::cancelled)
    throw core::Cancelled{};
  result.passes += bands.passes();
  if (!missing.any()) {
    result.texture.singular = start.singular;
  } else if (filled_spectrum(source, missing, options, context, result) == core::Status::cancelled) {
    throw core::Cancelled{};
  }
  return result;
}

EmResult learn_missing(core::FrameSource& source, const Missing& missing, const LearnOptions& learning,
                       const EmOptions& options, const core::Context& context) {
  learning.validate();
  options.validate();
  HeldSource held(source, missing, context);
  if (context.cancelled()) throw core::Cancelled{};
  const LearnResult start = learn(held, learning, context);
  EmResult result = maximise_likelihood(source, start.texture, options, missing, context);
  result.passes += start.passes + 1;
  std::vector<std::string> notes;  // the start's own are of a model that is no more
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
