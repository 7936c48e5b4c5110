// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/compression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/distances/pair_gram.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/model/archive.hpp"

namespace emberfold::dytex {

namespace {

constexpr Eigen::Index kBatch = 8;    // frames at a time; bounds the memory
constexpr Eigen::Index kRows = 1024;  // values of a block
constexpr std::size_t kParts = 16;    // partial sums; fixed, so that results do not depend on threads
constexpr float kLargestCode = 255;   // of Precision::u8

core::NpyArray halves(const core::NpyArray& array, const char* what) {
  const auto& wide = std::get<std::vector<float>>(array.data);
  std::vector<core::Half> narrow(wide.size());
  std::ranges::transform(wide, narrow.begin(), core::to_half);
  if (!std::ranges::all_of(narrow, [](core::Half h) { return std::isfinite(core::to_float(h)); }))
    throw core::InputError(std::string(what) +
                           " has a value beyond 65504, the most that f16 holds; keep f32");
  return {array.shape, array.fortran_order, std::move(narrow)};
}

void put_in_steps(const Eigen::MatrixXf& C, core::ModelArchive& archive) {
  const auto n = static_cast<std::size_t>(C.cols());
  std::vector<float> scales(n), offsets(n);
  std::vector<std::uint8_t> steps(static_cast<std::size_t>(C.size()));
  for (Eigen::Index i = 0; i < C.cols(); ++i) {
    const float low = C.col(i).minCoeff(), scale = (C.col(i).maxCoeff() - low) / kLargestCode;
    scales[static_cast<std::size_t>(i)] = scale;
    offsets[static_cast<std::size_t>(i)] = low;
    const float per_value = scale > 0 ? 1 / scale : 0;
    for (Eigen::Index row = 0; row < C.rows(); ++row)
      steps[static_cast<std::size_t>(i * C.rows() + row)] = static_cast<std::uint8_t>(
          std::clamp(std::nearbyint((C(row, i) - low) * per_value), 0.0F, kLargestCode));
  }
  archive.arrays["C"] = {{static_cast<std::size_t>(C.rows()), n}, true, std::move(steps)};
  archive.arrays["C_scale"] = {{n}, false, std::move(scales)};
  archive.arrays["C_offset"] = {{n}, false, std::move(offsets)};
}

/// Products of a texture and its compressed form ('): D = C'ᵀ C, G = C'ᵀ C', g = C'ᵀ (mean − mean').
struct Products {
  Eigen::MatrixXd G, D;
  Eigen::VectorXd g;
  double mean_error = 0;  // ‖mean − mean'‖²
};

Products products(const LinearDynamicTexture& texture, const LinearDynamicTexture& kept) {
  LinearDynamicTexture shown_p, shown_q;  // without states, so that components alone are compared
  const Eigen::Index n = texture.components();
  const auto bare = [n](const LinearDynamicTexture& from, LinearDynamicTexture& to) {
    to.info = from.info;
    to.mean = from.mean;
    to.C = from.C;
    to.weights = Eigen::VectorXd::Ones(n);
    to.A = Eigen::MatrixXd::Zero(n, n);
  };
  bare(texture, shown_p);
  bare(kept, shown_q);
  const auto gram = detail::pair_gram(shown_p, shown_q);
  return {block_qq(gram), block_pq(gram).transpose(), gram.products.col(2 * n).segment(n, n),
          gram.products(2 * n, 2 * n)};
}

void check_frames(const LinearDynamicTexture& texture, const core::ClipInfo& info) {
  const core::ClipInfo& own = texture.info;
  if (info.width == own.width && info.height == own.height && info.channels == own.channels) return;
  const auto text = [](const core::ClipInfo& i) {
    return std::to_string(i.width) + "×" + std::to_string(i.height) +
           (i.channels == 3 ? " in colour" : " in grey");
  };
  throw core::InputError("the clip's frames are " + text(info) + ", the model's " + text(own));
}

/// Sums parts that are computed separately.
template <class Value, class Body>
Value sum_of_parts(Eigen::Index m, Value zero, const Body& body) {
  std::vector<Value> parts(kParts, zero);
  const auto blocks = static_cast<std::size_t>((m + kRows - 1) / kRows);
  core::parallel_for(kParts, {}, [&](std::size_t part) {
    for (std::size_t b = blocks * part / kParts; b < blocks * (part + 1) / kParts; ++b) {
      const auto row = static_cast<Eigen::Index>(b) * kRows;
      body(parts[part], row, std::min(kRows, m - row));
    }
  });
  for (std::size_t part = 1; part < kParts; ++part) parts[0] += parts[part];
  return parts[0];
}

/// Returns ‖frames − their drawing‖² of some frames, levels, a column each.
double batch_error(const LinearDynamicTexture& texture, const detail::CholeskyFactors& gram,
                   const Eigen::MatrixXf& frames) {
  const Eigen::Index n = texture.components(), m = texture.pixels();
  const Eigen::MatrixXd shown = sum_of_parts(
      m, Eigen::MatrixXd(Eigen::MatrixXd::Zero(n, frames.cols())),
      [&](Eigen::MatrixXd& sum, Eigen::Index row, Eigen::Index rows) {
        const Eigen::MatrixXf away = frames.middleRows(row, rows).colwise() - texture.mean.segment(row, rows);
        sum += Eigen::MatrixXf(texture.C.middleRows(row, rows).transpose() * away).cast<double>();
      });
  const Eigen::MatrixXf states =
      n > 0 ? Eigen::MatrixXf(gram.solve(shown).cast<float>()) : Eigen::MatrixXf(0, frames.cols());
  return sum_of_parts(m, 0.0, [&](double& sum, Eigen::Index row, Eigen::Index rows) {
    Eigen::MatrixXf drawn = texture.C.middleRows(row, rows) * states;
    drawn.colwise() += texture.mean.segment(row, rows);
    const auto bytes = drawn.array().max(0.0F).min(255.0F).round();
    sum += (bytes - frames.middleRows(row, rows).array()).cast<double>().square().sum();
  });
}

}  // namespace

const char* name(Precision precision) {
  constexpr std::array<const char*, 3> kNames{"f32", "f16", "u8"};
  return kNames[static_cast<std::size_t>(precision)];
}

std::optional<Precision> precision_of(std::string_view text) {
  for (const Precision precision : kPrecisions)
    if (text == name(precision)) return precision;
  return std::nullopt;
}

core::ModelArchive to_archive(const LinearDynamicTexture& texture, Precision precision) {
  core::ModelArchive archive = to_archive(texture);
  if (precision == Precision::f32) return archive;
  archive.arrays["mean"] = halves(archive.arrays["mean"], "mean");
  if (precision == Precision::f16)
    archive.arrays["C"] = halves(archive.arrays["C"], "C");
  else
    put_in_steps(texture.C, archive);
  return archive;
}

LinearDynamicTexture rounded(const LinearDynamicTexture& texture, Precision precision) {
  return linear_dynamic_texture(to_archive(texture, precision));
}

std::size_t stored_bytes(const LinearDynamicTexture& texture, Eigen::Index components, Precision precision) {
  const Eigen::Index most = texture.components();
  if (components < 0 || components > most)
    throw core::InputError("components is " + std::to_string(components) + "; allowed is 0 to " +
                           std::to_string(most));
  // The states hold this number of values for each component, now and before.
  const Eigen::Index order = most > 0 ? texture.order() * components / most : texture.order();
  const Eigen::Index inputs = std::min(order, texture.B.cols()), m = texture.pixels();
  const Eigen::Index doubles =
      order * (order + inputs + texture.states.cols()) + texture.singular.size() + components;
  Eigen::Index bytes = 8 * doubles + 4 * texture.noise.size();
  switch (precision) {
    case Precision::f32:
      bytes += 4 * m * (components + 1);
      break;
    case Precision::f16:
      bytes += 2 * m * (components + 1);
      break;
    case Precision::u8:
      bytes += m * (components + 2) + 8 * components;
      break;
  }
  return static_cast<std::size_t>(bytes);
}

Eigen::VectorXd projection_errors(const LinearDynamicTexture& texture, Precision precision) {
  const auto kept = rounded(texture, precision);
  const Eigen::Index n = texture.components(), frames = texture.states.cols();
  const auto tau = static_cast<double>(frames);
  const auto [G, D, g, mean_error] = products(texture, kept);
  Eigen::VectorXd left = Eigen::VectorXd::Constant(n + 1, texture.singular.squaredNorm() + tau * mean_error);
  if (n > 0) {
    // Σ b bᵀ of b = C'ᵀ (y − mean'), less the part outside C: with G = L Lᵀ the first k components explain
    // the first k diagonal entries of L⁻¹ (Σ b bᵀ) L⁻ᵀ.
    const auto states = texture.states.topRows(n);
    const detail::CholeskyFactors root(G);
    if (!root.positive()) throw core::NumericalError("the components are not independent after rounding");
    const Eigen::MatrixXd shown = D * states;
    const Eigen::MatrixXd solved = root.solve_lower(shown.colwise() + g);
    double explained = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      explained += solved.row(k).squaredNorm();
      left[k + 1] -= explained;
    }
  }
  return left.cwiseMax(0) / (tau * static_cast<double>(texture.pixels()));
}

double measured_error(const LinearDynamicTexture& texture, core::FrameSource& source,
                      const core::Context& context) {
  check_frames(texture, source.info());
  const Eigen::Index m = texture.pixels(), expected = texture.states.cols();
  const detail::CholeskyFactors gram(products(texture, texture).G);
  Eigen::MatrixXf batch(m, kBatch);
  Eigen::Index count = 0, seen = 0;
  double error = 0;
  source.rewind();
  for (bool more = true; more;) {
    context.check();
    const cv::Mat frame = source.next();
    more = !frame.empty();
    if (more) {
      const cv::Mat levels = core::to_levels(frame, source.info());
      batch.col(count++) = Eigen::Map<const Eigen::VectorXf>(levels.ptr<float>(), m);
      ++seen;
      context.report("measure", std::min(1.0, static_cast<double>(seen) / static_cast<double>(expected)));
    }
    if (count == 0 || (more && count < kBatch)) continue;
    error += batch_error(texture, gram, batch.leftCols(count));
    count = 0;
  }
  if (seen != expected)
    throw core::InputError("the clip has " + std::to_string(seen) + " frames, the model was learned from " +
                           std::to_string(expected));
  return seen > 0 ? error / (static_cast<double>(seen) * static_cast<double>(m)) : 0;
}

}  // namespace emberfold::dytex
