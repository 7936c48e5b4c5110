// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/patch_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr std::array<double, 4> kThird = {-1, 3, -3, 1};
constexpr int kRounds = 40;  // of conjugate gradients, at most

constexpr double kUnevenness = 0.25;  // px, τ: SD of curves' third differences
constexpr double kLength = 6;         // px of the curve that one patch is seen by

/// SD of the place across that `noise` leaves: noise / √(length · ∫ slope²).
double place_error(const Patch& patch, double noise) {
  const double spread = std::max(std::sqrt(patch.blur * patch.blur + patch.width * patch.width / 12), 0.5);
  const double shape =
      graph::on_step(patch) ? 0.5 / std::sqrt(std::numbers::pi) : 0.5 * std::sqrt(std::numbers::pi);
  const double slopes = shape * patch.contrast * patch.contrast / spread;
  return noise / std::sqrt(std::max(kLength * slopes, 1e-6));
}

/// Displacements of a row of patches across their curve, the unknowns of the least squares.
class Row {
 public:
  Row(std::vector<Point> places, std::vector<Point> normals, std::vector<double> weights, bool ring)
      : places_(std::move(places)), normals_(std::move(normals)), weights_(std::move(weights)), ring_(ring) {}

  std::vector<double> solve() const {
    const std::size_t n = places_.size();
    std::vector<double> u(n, 0.0), r(n, 0.0);
    for_each_four([&](const std::array<std::size_t, 4>& at) {
      const Point third = bend(at, places_);
      for (std::size_t k = 0; k < 4; ++k)
        r[at[k]] -= kThird[k] * graph::dot(third, normals_[at[k]]) / (kUnevenness * kUnevenness);
    });
    std::vector<double> p(n, 0.0), q;
    double before = 0;
    for (int i = 0; i < kRounds; ++i) {
      // Jacobi's preconditioner: the weights span many orders.
      double product = 0;
      std::vector<double> z(n);
      for (std::size_t k = 0; k < n; ++k)
        z[k] = r[k] / (weights_[k] + 20 / (kUnevenness * kUnevenness)), product += r[k] * z[k];
      if (product < 1e-12) break;
      for (std::size_t k = 0; k < n; ++k) p[k] = z[k] + (i == 0 ? 0 : product / before) * p[k];
      q = times(p);
      double curvature = 0;
      for (std::size_t k = 0; k < n; ++k) curvature += p[k] * q[k];
      for (std::size_t k = 0; k < n; ++k) {
        u[k] += product / curvature * p[k];
        r[k] -= product / curvature * q[k];
      }
      before = product;
    }
    return u;
  }

 private:
  template <class Do>
  void for_each_four(Do act) const {
    const std::size_t n = places_.size(), count = ring_ ? n : n - 3;
    for (std::size_t i = 0; i < count; ++i)
      act(std::array<std::size_t, 4>{i, (i + 1) % n, (i + 2) % n, (i + 3) % n});
  }
  static Point bend(const std::array<std::size_t, 4>& at, const std::vector<Point>& points) {
    Point sum;
    for (std::size_t k = 0; k < 4; ++k) sum = sum + points[at[k]] * kThird[k];
    return sum;
  }
  [[nodiscard]] std::vector<double> times(const std::vector<double>& u) const {
    std::vector<double> result(u.size());
    for (std::size_t k = 0; k < u.size(); ++k) result[k] = weights_[k] * u[k];
    for_each_four([&](const std::array<std::size_t, 4>& at) {
      Point sum;
      for (std::size_t k = 0; k < 4; ++k) sum = sum + normals_[at[k]] * (kThird[k] * u[at[k]]);
      for (std::size_t k = 0; k < 4; ++k)
        result[at[k]] += kThird[k] * graph::dot(sum, normals_[at[k]]) / (kUnevenness * kUnevenness);
    });
    return result;
  }

  std::vector<Point> places_, normals_;
  std::vector<double> weights_;
  bool ring_;
};

/// minimise Σ (xᵢ − x̂ᵢ)²·wᵢ + Σ (xᵢ − xᵢ₊₁)²/τ²: a chain's most likely values. Thomas' elimination.
std::vector<double> evened(std::vector<double> x, const std::vector<double>& w, double tau) {
  const std::size_t n = x.size();
  const double tie = 1 / (tau * tau);
  std::vector<double> upper(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double sides = (i > 0 ? tie : 0) + (i + 1 < n ? tie : 0);
    const double pivot = w[i] + sides - (i > 0 ? tie * upper[i - 1] : 0);
    x[i] = (w[i] * x[i] + (i > 0 ? tie * x[i - 1] : 0)) / pivot;
    upper[i] = tie / pivot;
  }
  for (std::size_t i = n - 1; i-- > 0;) x[i] += upper[i] * x[i + 1];
  return x;
}

/// Visible share of a line's middle, 0…1.
double core(double width, double blur) {
  return 1 - std::erfc(width / (2 * std::numbers::sqrt2 * blur));
}

/// Width and blur change slowly along a curve; what is seen of the contrast stays.
void even_profiles(std::vector<graph::Vertex>& vertices, const graph::Curve& curve, std::size_t n,
                   double noise) {
  constexpr double kTold = 5;     // times less well than the place
  constexpr double kSlow = 0.15;  // px from patch to patch
  std::vector<double> widths, blurs, weights;
  for (std::size_t i = 0; i < n; ++i) {
    const Patch& patch = vertices[curve[i]].patch;
    const double error = std::max(kTold * place_error(patch, noise), 1e-3);
    widths.push_back(patch.width);
    blurs.push_back(patch.blur);
    weights.push_back(1 / (error * error));
  }
  widths = evened(std::move(widths), weights, kSlow);
  blurs = evened(std::move(blurs), weights, kSlow);
  for (std::size_t i = 0; i < n; ++i) {
    Patch& patch = vertices[curve[i]].patch;
    if (!graph::on_step(patch) && patch.width > 0 && patch.blur > 0) {
      const double more = core(patch.width, patch.blur) / std::max(core(widths[i], blurs[i]), 0.05);
      for (std::size_t c = 0; c < 3; ++c) {
        const float sides = 0.5F * (patch.left[c] + patch.right[c]);
        patch.middle[c] = sides + static_cast<float>(more) * (patch.middle[c] - sides);
      }
      patch.width = widths[i];
    }
    patch.blur = blurs[i];
  }
}

}  // namespace

graph::AttributeGraph smooth_patches(const graph::AttributeGraph& graph, double noise) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (const graph::Curve& curve : graph::curves(graph)) {
    const bool ring = curve.size() > 1 && curve.front() == curve.back();
    const std::size_t n = curve.size() - (ring ? 1 : 0);
    if (n < 5) continue;
    std::vector<Point> places, normals;
    std::vector<double> weights;
    for (std::size_t i = 0; i < n; ++i) {
      const Patch& patch = graph.patch(curve[i]);
      const bool fixed = graph.degree(curve[i]) > 2 || patch.type == graph::PatchType::corner;
      const double error = std::max(place_error(patch, noise), 1e-3);
      places.push_back(patch.position);
      normals.push_back(fixed ? Point{} : Point{-std::sin(patch.theta), std::cos(patch.theta)});
      weights.push_back(1 / (error * error));
    }
    const std::vector<double> moved = Row(places, normals, weights, ring).solve();
    for (std::size_t i = 0; i < n; ++i) {
      const double most = 3 * place_error(graph.patch(curve[i]), noise);
      vertices[curve[i]].patch.position = places[i] + normals[i] * std::clamp(moved[i], -most, most);
    }
    even_profiles(vertices, curve, n, noise);
  }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace emberfold::sketch
