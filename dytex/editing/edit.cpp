// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/edit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "core/text/format_number.hpp"
#include "dytex/editing/edit_dynamics.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Largest and smallest factors of edits; the scales of Doretto, Soatto 2003 go to 2.
constexpr double kMostSpeed = 3, kMostIntensity = 3, kMostWeight = 10, kLeastFlow = 0.01, kMostFlow = 100;
// Number of the last component of the coarse and of the medium group (Doretto, Soatto 2003, eq. 3).
constexpr Index kLastCoarse = 5, kLastMedium = 15;
constexpr double kReportedCut = 1e-9;  // share of the noise; a smaller cut is rounding

template <class... Each>
struct Overloaded : Each... {
  using Each::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

void check_all(const std::string& name, const std::vector<double>& values, double most) {
  if (values.empty()) throw core::InputError(name + " is empty, must have at least one number");
  for (std::size_t i = 0; i < values.size(); ++i)
    core::check_range(name + "[" + std::to_string(i) + "]", values[i], 0, most);
}

/// The texture being edited, and what an edit acts on.
struct Work {
  EditResult result;
  const Edit* edit = nullptr;

  [[nodiscard]] LinearDynamicTexture& texture() { return result.texture; }
  [[nodiscard]] const LinearDynamicTexture& texture() const { return result.texture; }
  void note(const std::string& text) { result.notes.push_back(text); }
};

/// tr W P W of the components; unweighted where all weights are 0.
double contrast(const LinearDynamicTexture& texture, const MatrixXd& P) {
  const VectorXd variances = P.diagonal().head(texture.components());
  const double shown = variances.dot(texture.weights.cwiseAbs2());
  return shown > 0 ? shown : variances.sum();
}

void note_losses(Work& work, const detail::EditedDynamics& edited) {
  work.result.dropped += edited.dropped;
  if (edited.dropped > 0)
    work.note(std::to_string(edited.dropped) + " of the poles became 0: their phase would have passed pi");
  if (edited.wrapped > 0)
    work.note(
        std::to_string(edited.wrapped) +
        " of the poles turn by more than half a circle a frame: they wrap around, as in every n-th frame");
  if (edited.together > 0)
    work.note(std::to_string(edited.together) +
              " of the poles lie too close together and were turned as one");
  if (edited.cut > kReportedCut)
    work.note(
        "no noise keeps the covariance exactly at this pace: " + core::significant_text(100 * edited.cut, 6) +
        " % of the noise that would was negative and was cut");
}

using Change = std::function<detail::EditedDynamics(const MatrixXd&, const MatrixXd&)>;

/// Makes a new A; `rescale`: scales B to keep the contrast.
void change_dynamics(Work& work, const Change& change, bool keep_noise, bool rescale) {
  LinearDynamicTexture& texture = work.texture();
  detail::EditedDynamics edited = change(texture.A, texture.B);
  if (keep_noise) edited.B = texture.B;
  if (rescale) {
    const double before = contrast(texture, stationary_covariance(texture.A, texture.B));
    const double after = contrast(texture, stationary_covariance(edited.A, edited.B));
    if (after > 0) edited.B *= std::sqrt(before / after);
  }
  note_losses(work, edited);
  texture.A = edited.A;
  texture.B = edited.B;
}

void apply(Work& work, const Speed& speed) {
  if (speed.factor == 1) return;
  const bool contrast = work.edit->keep_contrast;
  change_dynamics(
      work, [&](const MatrixXd& A, const MatrixXd& B) { return detail::at_speed(A, B, speed.factor); }, true,
      contrast);
}

void apply(Work& work, const Flow& flow) {
  if (flow.factor == 1) return;
  if (flow.factor == 0) {
    change_dynamics(work, detail::at_rest, false, false);
    return;
  }
  const bool contrast = work.edit->keep_contrast;
  change_dynamics(
      work, [&](const MatrixXd& A, const MatrixXd& B) { return detail::at_flow(A, B, flow.factor); },
      !contrast, contrast);
}

void apply(Work& work, const Reverse&) {
  change_dynamics(work, detail::reverse_dynamics, false, false);
}

void apply(Work& work, const Intensity& intensity) {
  if (intensity.factor != 1) work.texture().B *= std::sqrt(intensity.factor);
}

void apply(Work& work, const Directions& directions) {
  if (std::ranges::all_of(directions.factors, [](double f) { return f == 1; })) return;
  const auto count = static_cast<Index>(directions.factors.size());
  const MatrixXd B = work.texture().B;
  if (count > B.rows())
    throw core::InputError("directions has " + std::to_string(count) + " numbers, Q has " +
                           std::to_string(B.rows()) + " eigenvalues");
  const MatrixXd U = detail::symmetric_eigen(B * B.transpose()).vectors;
  VectorXd scale = VectorXd::Ones(B.rows());
  scale.head(count) = Eigen::Map<const VectorXd>(directions.factors.data(), count).cwiseSqrt();
  work.texture().B = U * scale.asDiagonal() * (U.transpose() * B);
}

void apply(Work& work, const Scales& scales) {
  const std::array factors{scales.coarse, scales.medium, scales.fine};
  constexpr std::array names{"coarse", "medium", "fine"};
  constexpr std::array<Index, 3> first{0, kLastCoarse, kLastMedium};
  LinearDynamicTexture& texture = work.texture();
  for (Index i = 0; i < texture.components(); ++i)
    texture.weights[i] *= factors[i < kLastCoarse ? 0 : i < kLastMedium ? 1 : 2];
  for (std::size_t scale = 0; scale < 3; ++scale)
    if (factors[scale] != 1 && texture.components() <= first[scale])
      work.note(std::string("the model has no ") + names[scale] + " components: it is of order " +
                std::to_string(texture.components()));
}

void apply(Work& work, const Weights& weights) {
  LinearDynamicTexture& texture = work.texture();
  const auto count = static_cast<Index>(weights.factors.size());
  if (count > texture.components())
    throw core::InputError("weights has " + std::to_string(count) + " numbers, there are " +
                           std::to_string(texture.components()) + " components");
  texture.weights.head(count).array() *= Eigen::Map<const Eigen::ArrayXd>(weights.factors.data(), count);
}

}  // namespace

void validate(const Edit& edit) {
  std::visit(
      Overloaded{[](const Speed& e) { core::check_range("speed", e.factor, -kMostSpeed, kMostSpeed); },
                 [](const Flow& e) {
                   if (e.factor != 0) core::check_range("flow", e.factor, kLeastFlow, kMostFlow);
                 },
                 [](const Reverse&) {},
                 [](const Intensity& e) { core::check_range("intensity", e.factor, 0, kMostIntensity); },
                 [](const Directions& e) { check_all("directions", e.factors, kMostIntensity); },
                 [](const Scales& e) {
                   core::check_range("coarse", e.coarse, 0, kMostWeight);
                   core::check_range("medium", e.medium, 0, kMostWeight);
                   core::check_range("fine", e.fine, 0, kMostWeight);
                 },
                 [](const Weights& e) { check_all("weights", e.factors, kMostWeight); }},
      edit.what);
}

EditResult edit(LinearDynamicTexture texture, std::span<const Edit> edits) {
  validate(texture);
  for (const Edit& one : edits) validate(one);
  Work work;
  work.result.texture = std::move(texture);
  for (const Edit& one : edits) {
    work.edit = &one;
    if (work.texture().components() == 0) {
      work.note("the model has no components: there is nothing to edit");
      break;
    }
    std::visit([&](const auto& what) { apply(work, what); }, one.what);
  }
  return std::move(work.result);
}

}  // namespace emberfold::dytex
