// SPDX-License-Identifier: Apache-2.0
#include "mcmc/model/motion_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "core/error.hpp"
#include "core/text/format_number.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/patch_range.hpp"

namespace emberfold::mcmc {

namespace {

// The larger root of z² = a1 z + a2.
double radius(double a1, double a2) {
  const std::complex<double> root = std::sqrt(std::complex<double>(a1 * a1 + 4 * a2, 0));
  return std::max(std::abs(a1 + root), std::abs(a1 - root)) / 2;
}

[[noreturn]] void refuse(const std::string& part, const std::string& why) {
  throw core::InputError("motion model: " + part + " " + why);
}

void check(bool holds, const std::string& part, const std::string& why) {
  if (!holds) refuse(part, why);
}

void check(const Autoregression& m, const std::string& part) {
  for (const double value : {m.a1, m.a2, m.coupling, m.noise, m.range, m.measurement})
    check(std::isfinite(value), part, "holds a number that is not finite");
  check(m.coupling >= 0 && m.coupling <= 1, part, "has a coupling outside 0…1");
  check(m.noise >= 0 && m.measurement >= 0, part, "has a negative deviation");
  check(m.range >= 0 && m.range <= 1e4, part, "has a range outside 0…10000 px");
  const double r = spectral_radius(m);
  check(r < 1, part, "is not stable: spectral radius " + core::number_text(r) + ", allowed is below 1");
}

void check(const CellMap& map, const MotionModel& model, const std::string& part, double least) {
  check(map.cell >= 1 && map.cell <= 65536, part, "has cells outside 1…65536 px");
  check(map.cell == model.density.cell, part,
        "has cells of " + core::number_text(map.cell) + " px, the density map of " +
            core::number_text(model.density.cell));
  const auto cells = [&](int size) { return static_cast<int>(std::ceil(size / map.cell)); };
  check(map.columns == cells(model.width) && map.rows == cells(model.height), part,
        "does not cover the frame with its " + std::to_string(map.columns) + " x " +
            std::to_string(map.rows) + " cells");
  check(map.values.size() == static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), part,
        "has " + std::to_string(map.values.size()) + " values for " + std::to_string(map.columns) + " x " +
            std::to_string(map.rows) + " cells");
  for (const double value : map.values)
    check(std::isfinite(value) && value >= least && value <= 1e6, part,
          "holds " + core::number_text(value) + ", which is out of range");
}

void check(const graph::AttributeGraph& graph, const std::string& part) {
  for (const auto& vertex : graph.vertices()) {
    const auto complaint = graph::detail::describe_range_error(vertex.patch);
    check(complaint.empty(), part, "holds a patch that is none: " + complaint);
    check(!graph::is_anchor(vertex.patch), part, "holds an anchor, which is for sketches alone");
  }
}

// Bounds the amplitudes: their stationary covariance is the identity.
void check(const VelocityModes& velocity, std::size_t cells) {
  const std::size_t n = velocity.count;
  const std::string part = "velocity_modes";
  check(velocity.modes.size() == 2 * cells * n && velocity.step.size() == n * n &&
            velocity.noise.size() == n * n,
        part, "has sizes that disagree with its " + std::to_string(n) + " modes");
  for (const auto* values : {&velocity.modes, &velocity.step, &velocity.noise})
    for (const double value : *values)
      check(std::isfinite(value) && std::abs(value) <= 1e6, part,
            "holds " + core::number_text(value) + ", which is out of range");
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < n; ++k)
        sum += velocity.step[i * n + k] * velocity.step[j * n + k] +
               velocity.noise[i * n + k] * velocity.noise[j * n + k];
      check(std::abs(sum - (i == j ? 1 : 0)) <= 1e-6, part, "has amplitudes whose variance does not stay 1");
    }
}

void check_share(double value, const std::string& part) {
  check(value >= 0 && value <= 1, part, "is " + core::number_text(value) + "; allowed is 0…1");
}

}  // namespace

double spectral_radius(const Autoregression& m) {
  // n̄ − d multiplies a deviation by a factor between −2 and 0, whatever the graph.
  double largest = 0;
  for (int step = 0; step <= 8; ++step)
    largest = std::max(largest, radius(m.a1 - m.coupling * step / 4.0, m.a2));
  return largest;
}

double stationary_deviation(const Autoregression& m) {
  const double worst = spectral_radius(m);
  if (!(worst < 1)) throw core::InputError("a motion that is not stable has no stationary state");
  // Along an endless curve every spatial frequency is an AR(2) of its own.
  constexpr int steps = 256;
  constexpr double spacing = 5;  // px from patch to patch
  double variance = 0, mass = 0;
  for (int i = 0; i < steps; ++i) {
    const double frequency = std::numbers::pi * (i + 0.5) / steps;
    const double a = m.a1 - m.coupling * (1 - std::cos(frequency)), b = m.a2;
    const double force = std::exp(-0.5 * std::pow(frequency * m.range / spacing, 2));
    variance += force * (1 - b) / ((1 + b) * ((1 - b) * (1 - b) - a * a));
    mass += force;
  }
  return m.noise * std::sqrt(variance / mass);
}

std::size_t size_class(std::size_t patches) {
  std::size_t size = 0;
  for (std::size_t limit = 4; size + 1 < kSizeClasses && patches > limit; limit *= 2) ++size;
  return size;
}

void validate(const MotionModel& model) {
  check(model.width >= 1 && model.width <= 65536 && model.height >= 1 && model.height <= 65536, "the frame",
        "is " + std::to_string(model.width) + " x " + std::to_string(model.height) +
            " px; allowed is 1…65536 each way");
  check(model.fps > 0 && model.fps <= 1e6, "fps",
        "is " + core::number_text(model.fps) + "; allowed is (0, 1e6]");
  check(model.frames >= 2, "frames", "is " + std::to_string(model.frames) + "; at least 2");
  check(model.displacement, "sway");
  check(model.contrast, "contrast");
  check(model.drift_x, model, "drift_x", -1e6);
  check(model.drift_y, model, "drift_y", -1e6);
  check(model.velocity, model.drift_x.values.size());
  check(model.rates.birth, model, "the birth map", 0);
  check(model.rates.death, model, "the death map", 0);
  check(model.rates.separation, model, "the parting map", 0);
  check(model.displacement_scale, model, "sway_share", 0);
  check(model.density, model, "the density map", 0);
  for (const double share : model.rates.birth_by_size) check_share(share, "a share of births");
  for (const double rate : model.rates.death_by_size) check_share(rate, "a death rate");
  check_share(model.rates.split, "the split rate");
  check_share(model.rates.merge, "the merge rate");
  check_share(model.rates.connect, "the connect rate");
  check_share(model.rates.disconnect, "the disconnect rate");
  for (const double length : {model.rates.reach, model.rates.split_gap, model.rates.disconnect_gap})
    check(length >= 0 && length <= 1000, "a gap",
          "is " + core::number_text(length) + " px; allowed is 0…1000");
  check(model.rates.refractory_period >= 0 && model.rates.refractory_period <= 1000, "hold",
        "is " + core::number_text(model.rates.refractory_period) + " frames; allowed is 0…1000");
  const auto& after = model.rates.modifiers;
  const auto check_multiples = [&](const auto& multiples) {
    for (const double multiple : multiples)
      check(multiple >= 0 && multiple <= 1e6, "circumstances",
            "holds " + core::number_text(multiple) + ", which is out of range");
  };
  for (const auto* multiples : {&after.death, &after.separation, &after.unification, &after.bridging})
    check_multiples(*multiples);
  check_multiples(after.turning);
  check(after.pace >= 1e-3 && after.pace <= 1e3, "circumstances",
        "has a pace of " + core::number_text(after.pace) + "; allowed is 0.001…1000");
  for (const double far : {model.hard_core.alike, model.hard_core.lines, model.hard_core.mixed})
    check(far >= 0 && far <= 1000, "exclusion", "holds " + core::number_text(far) + " px; allowed is 0…1000");
  for (const double share : model.appearing) check_share(share, "appearing");
  for (const double share : model.vanishing) check_share(share, "vanishing");
  for (const auto& exemplar : model.exemplars) {
    check(!exemplar.graph.empty(), "an exemplar", "is empty");
    check(std::isfinite(exemplar.place.x) && std::isfinite(exemplar.place.y) &&
              std::isfinite(exemplar.clearance) && exemplar.clearance >= 0,
          "an exemplar", "has no finite place");
    check(exemplar.graph, "an exemplar");
  }
  check(model.first, "the first frame");
}

}  // namespace emberfold::mcmc
