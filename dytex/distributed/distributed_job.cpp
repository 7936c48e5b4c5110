// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/distributed_job.hpp"

#include <cstring>
#include <utility>

#include "core/error.hpp"
#include "dytex/distributed/stripe_products.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr const char* kProgress = "progress";

void gather_mean(const DistributedJob& job, const StripeMeans& means, LearnResult& learned) {
  const double to_levels = 255 / job.rounds.info().white;
  Eigen::VectorXf own(0);
  for (const auto& [stripe, mean] : means) {
    own.conservativeResize(own.size() + mean.size());
    own.tail(mean.size()) = (mean * to_levels).cast<float>();
  }
  const auto bytes = [](float* data, std::size_t count) {
    return std::as_writable_bytes(std::span(data, count));
  };
  if (!job.is_root()) return job.ranks.send(0, bytes(own.data(), static_cast<std::size_t>(own.size())));
  Eigen::VectorXf& mean = learned.texture.mean;
  mean.resize(static_cast<Eigen::Index>(job.stripes.values()));
  mean.head(own.size()) = own;
  for (int r = 1; r < job.ranks.ranks(); ++r) {
    const std::size_t begin = job.stripes.begin(job.stripes.first_of(r)),
                      end = job.stripes.begin(job.stripes.first_of(r + 1));
    job.ranks.receive(r, bytes(mean.data() + begin, end - begin));
  }
}

/// Returns the factor that makes columns orthonormal: L⁻ᵀ with CᵀC = L Lᵀ.
Eigen::MatrixXd orthonormalising(const DistributedJob& job, const StripeRows& C, Eigen::Index n) {
  const Eigen::MatrixXd products =
      sum_stripes(job.ranks, job.stripes, n, n, false, true, [&](std::size_t stripe, Eigen::MatrixXd& sum) {
        add_stripe_products({&C.at(stripe)}, sum, job.context);
      });
  Eigen::MatrixXd right;
  together(job.ranks, [&] {
    if (!job.is_root()) return;
    const CholeskyFactors factors(products);
    if (!factors.positive()) throw core::NumericalError("learn: the components are not independent");
    right = factors.solve_lower(Eigen::MatrixXd::Identity(n, n)).transpose();
  });
  broadcast_matrix(job.ranks, right);
  return right;
}

}  // namespace

Progress load_progress(const DistributedJob& job) {
  Progress progress;
  together(job.ranks, [&] {
    const auto kept = job.keeper.load(kProgress);
    if (kept && kept->size() == sizeof progress) std::memcpy(&progress, kept->data(), sizeof progress);
  });
  return progress;
}

void save_progress(const DistributedJob& job, Progress progress) {
  together(job.ranks, [&] { job.keeper.flush(); });
  together(job.ranks, [&] {
    if (job.is_root()) job.keeper.save(kProgress, std::as_bytes(std::span(&progress, 1)));
  });
}

FrameValues stripe_values(const DistributedJob& job, std::size_t stripe, const std::byte* values,
                          std::size_t frames) {
  FrameValues result{{}, job.stripes.size(stripe), job.rounds.info().depth};
  const std::size_t frame_bytes = result.count * job.rounds.value_bytes();
  for (std::size_t t = 0; t < frames; ++t) result.frames.push_back(values + t * frame_bytes);
  return result;
}

StripeMeans stripe_means(const DistributedJob& job, std::size_t frames,
                         const std::function<FrameValues(std::size_t)>& values) {
  StripeMeans means;
  together(job.ranks, [&] {
    for (std::size_t s = job.first_stripe(); s < job.end_stripe(); ++s) {
      Eigen::VectorXd& mean = means[s];
      mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(job.stripes.size(s)));
      add_sums(values(s), 0, mean, job.context);
      mean /= static_cast<double>(frames);
    }
  });
  return means;
}

Eigen::MatrixXd gram_of_stripes(const DistributedJob& job, std::size_t frames,
                                const std::function<FrameValues(std::size_t)>& values) {
  const auto size = static_cast<Eigen::Index>(frames);
  return sum_stripes(
      job.ranks, job.stripes, size, size, job.rounds.info().depth == CV_8U, true,
      [&](std::size_t stripe, Eigen::MatrixXd& sum) { add_gram(values(stripe), sum, job.context); });
}

void finish_model(const DistributedJob& job, StripeRows C, const StripeMeans& means, LearnResult& learned) {
  gather_mean(job, means, learned);
  const Eigen::Index n = broadcast_number(job.ranks, learned.texture.components());
  const Eigen::MatrixXd right = n > 0 ? orthonormalising(job, C, n) : Eigen::MatrixXd(0, 0);
  together(job.ranks, [&] {
    if (job.is_root()) job.rows.begin(n);
  });
  together(job.ranks, [&] {
    if (n == 0) return;
    for (auto& [stripe, rows] : C) {
      rows = product({&rows}, right, job.context);
      job.rows.put(job.stripes.begin(stripe), rows);
    }
  });
}

}  // namespace emberfold::dytex::detail
