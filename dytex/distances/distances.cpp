// SPDX-License-Identifier: Apache-2.0
#include "dytex/distances/distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/distances/pair_gram.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

/// Σ (Aₚᵀ)ᵗ Cₚᵀ C_q A_qᵗ over all frames.
Eigen::MatrixXd observed(const Eigen::MatrixXd& A_p, const Eigen::MatrixXd& A_q,
                         const Eigen::MatrixXd& products) {
  return detail::doubled_sum(A_p.transpose(), A_q, products);
}

/// F with Fᵀ P F = I on the directions in which the symmetric P is not 0.
Eigen::MatrixXd whitening(const Eigen::MatrixXd& P) {
  const auto eigen = detail::symmetric_eigen((P + P.transpose()) / 2);
  const double least =
      static_cast<double>(P.rows()) * std::numeric_limits<double>::epsilon() * eigen.values[0];
  const Eigen::Index rank = (eigen.values.array() > least).count();
  return eigen.vectors.leftCols(rank) * eigen.values.head(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

Eigen::VectorXd angles_of(const LinearDynamicTexture& p, const LinearDynamicTexture& q,
                          const detail::PairGram& gram) {
  const Eigen::MatrixXd left = whitening(observed(p.A, p.A, block_pp(gram)));
  const Eigen::MatrixXd right = whitening(observed(q.A, q.A, block_qq(gram)));
  const Eigen::VectorXd cosines =
      detail::singular_values(left.transpose() * observed(p.A, q.A, block_pq(gram)) * right);
  const double rounding =
      16 * static_cast<double>(left.rows() + right.rows()) * std::numeric_limits<double>::epsilon();
  return cosines.unaryExpr([&](double c) { return c >= 1 - rounding ? 0.0 : std::acos(c); });
}

Distances distances_of_models(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  const auto gram = detail::pair_gram(p, q);
  Distances result;
  if (has_noise(p) && has_noise(q)) {
    result.kl = detail::kl_rate(p, q, gram);
    result.kl_back = detail::kl_rate(q, p, gram.swapped());
  }
  if (p.order() > 0 && q.order() > 0) result.angles = angles_of(p, q, gram);
  return result;
}

std::optional<double> windows_apart(const WindowSpectrum& p, const WindowSpectrum& q) {
  if (!p || !q) return std::nullopt;
  return window_distance(*p, *q);
}

}  // namespace

Eigen::VectorXd subspace_angles(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  detail::check_pair(p, q);
  for (const auto& [texture, which] : {std::pair{&p, "first"}, {&q, "second"}})
    if (texture->order() == 0)
      throw core::InputError(std::string("the ") + which + " model has no components, so no angles");
  return angles_of(p, q, detail::pair_gram(p, q));
}

double martin_distance(const Eigen::Ref<const Eigen::VectorXd>& angles) {
  const double sum = angles.array().cos().log().sum();
  return sum < 0 ? std::sqrt(-2 * sum) : 0;
}

double grassmann_distance(const Eigen::Ref<const Eigen::VectorXd>& angles) {
  return angles.norm();
}

const char* name(Measure measure) {
  constexpr std::array<const char*, 4> kNames{"kl", "martin", "angles", "windows"};
  return kNames[static_cast<std::size_t>(measure)];
}

Distances distances(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  Distances result = distances_of_models(p, q);
  result.windows = windows_apart(window_spectrum(p), window_spectrum(q));
  return result;
}

bool has(const Distances& distances, Measure measure) {
  if (measure == Measure::kl) return distances.kl.has_value();
  if (measure == Measure::windows) return distances.windows.has_value();
  return distances.angles.size() > 0;
}

double distance(const Distances& distances, Measure measure) {
  switch (measure) {
    case Measure::kl:
      if (!distances.kl)
        throw core::InputError(
            "a model's noise r is 0, so the KL rate is infinite; learn with fewer "
            "components than the clip has independent frames, so that r is estimated");
      return *distances.kl;
    case Measure::windows:
      if (!distances.windows)
        throw core::InputError(
            "a texture has no windows that move: frames are at least 16x16, clips 32 frames");
      return *distances.windows;
    case Measure::martin:
    case Measure::angles:
      break;
  }
  if (distances.angles.size() == 0)
    throw core::InputError("a model has no components, so there are no angles");
  return measure == Measure::martin ? martin_distance(distances.angles)
                                    : grassmann_distance(distances.angles);
}

std::vector<Distances> all_distances(std::span<const LinearDynamicTexture> models,
                                     const core::Context& context, std::span<const WindowSpectrum> windows) {
  if (!windows.empty() && windows.size() != models.size())
    throw core::InputError("all_distances: " + std::to_string(windows.size()) + " descriptions are not of " +
                           std::to_string(models.size()) + " models");
  for (std::size_t i = 1; i < models.size(); ++i) {
    try {
      detail::check_pair(models[0], models[i]);
    } catch (const core::InputError& error) {
      throw core::InputError("model " + std::to_string(i) + ": " + error.what());
    }
  }
  std::vector<WindowSpectrum> own;
  if (windows.empty()) windows = own = window_spectra(models, context);
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t i = 0; i < models.size(); ++i)
    for (std::size_t j = i; j < models.size(); ++j) places.emplace_back(i, j);
  std::vector<Distances> result(places.size());
  core::parallel_for(places.size(), context, [&](std::size_t k) {
    const auto [i, j] = places[k];
    result[k] = distances_of_models(models[i], models[j]);
    result[k].windows = windows_apart(windows[i], windows[j]);
  });
  return result;
}

Eigen::MatrixXd distance_matrix(std::span<const Distances> pairs, Measure measure) {
  const Eigen::Index models = std::lround((std::sqrt(8.0 * double(pairs.size()) + 1) - 1) / 2);
  if (models * (models + 1) / 2 != static_cast<Eigen::Index>(pairs.size()))
    throw core::InputError("distance_matrix: " + std::to_string(pairs.size()) +
                           " pairs are not all pairs of any number of models");
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Constant(models, models, std::numeric_limits<double>::quiet_NaN());
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < models; ++i)
    for (Eigen::Index j = i; j < models; ++j, ++k) {
      if (!has(pairs[k], measure)) continue;
      result(i, j) = result(j, i) = distance(pairs[k], measure);
      if (measure == Measure::kl) result(j, i) = *pairs[k].kl_back;
    }
  return result;
}

}  // namespace emberfold::dytex
