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
#include "dytex/editing/edit_groups.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

using detail::Group;
using detail::groups;
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

/// tr W P W of the group's components; unweighted where all weights are 0.
double contrast(const LinearDynamicTexture& texture, const Group& group, const MatrixXd& P) {
  VectorXd variances(group.shown), weights(group.shown);
  for (Index i = 0; i < group.shown; ++i) {
    variances[i] = P(i, i);
    weights[i] = texture.weights[group.states[static_cast<std::size_t>(i)]];
  }
  const double shown = variances.dot(weights.cwiseAbs2());
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

/// Stores the group's new dynamics.
void store_group(Work& work, const Group& group, const detail::EditedDynamics& edited) {
  LinearDynamicTexture& texture = work.texture();
  texture.A(group.states, group.states) = edited.A;
  if (edited.B.cols() > texture.B.cols()) {
    const Index before = texture.B.cols();
    texture.B.conservativeResize(Eigen::NoChange, edited.B.cols());
    texture.B.rightCols(edited.B.cols() - before).setZero();
  }
  texture.B(group.states, Eigen::seq(0, edited.B.cols() - 1)) = edited.B;
}

using Change = std::function<detail::EditedDynamics(const MatrixXd&, const MatrixXd&)>;

/// Makes a new A for every group; `rescale`: scales B to keep the contrast.
void change_dynamics(Work& work, const Change& change, bool keep_noise, bool rescale) {
  for (const Group& group : groups(work.texture(), work.edit->channel)) {
    const MatrixXd A = work.texture().A(group.states, group.states);
    const MatrixXd B = work.texture().B(group.states, Eigen::all);
    detail::EditedDynamics edited = change(A, B);
    if (keep_noise) edited.B = B;
    if (rescale) {
      const double before = contrast(work.texture(), group, stationary_covariance(A, B));
      const double after = contrast(work.texture(), group, stationary_covariance(edited.A, edited.B));
      if (after > 0) edited.B *= std::sqrt(before / after);
    }
    note_losses(work, edited);
    store_group(work, group, edited);
  }
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
  if (intensity.factor == 1) return;
  for (const Group& group : groups(work.texture(), work.edit->channel))
    work.texture().B(group.states, Eigen::all) *= std::sqrt(intensity.factor);
}

void apply(Work& work, const Directions& directions) {
  if (std::ranges::all_of(directions.factors, [](double f) { return f == 1; })) return;
  const auto count = static_cast<Index>(directions.factors.size());
  for (const Group& group : groups(work.texture(), work.edit->channel)) {
    const auto size = static_cast<Index>(group.states.size());
    if (count > size)
      throw core::InputError("directions has " + std::to_string(count) + " numbers, Q has " +
                             std::to_string(size) + " eigenvalues");
    const MatrixXd B = work.texture().B(group.states, Eigen::all);
    const MatrixXd U = detail::symmetric_eigen(B * B.transpose()).vectors;
    VectorXd scale = VectorXd::Ones(size);
    scale.head(count) = Eigen::Map<const VectorXd>(directions.factors.data(), count).cwiseSqrt();
    work.texture().B(group.states, Eigen::all) = U * scale.asDiagonal() * (U.transpose() * B);
  }
}

void apply(Work& work, const Scales& scales) {
  const std::array factors{scales.coarse, scales.medium, scales.fine};
  constexpr std::array names{"coarse", "medium", "fine"};
  std::array<bool, 3> found{};
  for (const Group& group : groups(work.texture(), work.edit->channel))
    for (Index i = 0; i < group.shown; ++i) {
      const std::size_t scale = i < kLastCoarse ? 0 : i < kLastMedium ? 1 : 2;
      work.texture().weights[group.states[static_cast<std::size_t>(i)]] *= factors[scale];
      found[scale] = true;
    }
  for (std::size_t scale = 0; scale < 3; ++scale)
    if (factors[scale] != 1 && !found[scale])
      work.note(std::string("the model has no ") + names[scale] + " components: it is of order " +
                std::to_string(work.texture().components()));
}

void apply(Work& work, const Weights& weights) {
  const auto count = static_cast<Index>(weights.factors.size());
  for (const Group& group : groups(work.texture(), work.edit->channel)) {
    if (count > group.shown)
      throw core::InputError("weights has " + std::to_string(count) + " numbers, there are " +
                             std::to_string(group.shown) + " components");
    for (Index i = 0; i < count; ++i)
      work.texture().weights[group.states[static_cast<std::size_t>(i)]] *=
          weights.factors[static_cast<std::size_t>(i)];
  }
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
  if (edit.channel && (*edit.channel < 0 || *edit.channel > 2))
    throw core::InputError("channel is " + std::to_string(*edit.channel) + "; allowed is 0 to 2");
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
