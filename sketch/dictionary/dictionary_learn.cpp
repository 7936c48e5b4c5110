// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/math/kmeans.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "sketch/dictionary/dictionary.hpp"
#include "sketch/dictionary/patch_views.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::size_t kMostProfiles = 4096, kMostWindows = 1536;  // held of a group
constexpr double kEven = 0.5;                                     // grey levels, RMS: below, nothing is seen
constexpr int kStarts = 3, kRounds = 25;
constexpr double kLeastGain = 1e-6;       // of the squares: a round that gains less is the last
constexpr std::size_t kLeastMembers = 8;  // of a cluster, if there are several
constexpr std::size_t kLeastForEach = 4;  // members for each component
constexpr double kLeastVariance = 1e-4;   // of what has an RMS of 1
constexpr std::uint32_t kSampling = 1, kClustering = 2;

using Vector = std::vector<float>;

/// Level and contrast off: mean 0, RMS 1. Empty where there is hardly any contrast.
Vector normalised(const Vector& view) {
  double mean = 0, square = 0;
  for (const float v : view) mean += double{v};
  mean /= static_cast<double>(view.size());
  for (const float v : view) square += (double{v} - mean) * (double{v} - mean);
  const double rms = std::sqrt(square / static_cast<double>(view.size()));
  if (!(rms >= kEven)) return {};
  Vector result(view.size());
  for (std::size_t i = 0; i < view.size(); ++i)
    result[i] = static_cast<float>((double{view[i]} - mean) / rms);
  return result;
}

struct Clustering {
  std::vector<std::uint32_t> of_sample;
  double squares = std::numeric_limits<double>::infinity();
};

Clustering cluster(const std::vector<Vector>& samples, std::size_t count, core::Rng rng) {
  Clustering found;
  found.of_sample =
      core::lloyd(samples, core::kmeans_plus_plus(samples, count, rng), kRounds, [&](const auto& state) {
        if (state.squares >= found.squares * (1 - kLeastGain)) return true;
        found.squares = state.squares;
        return false;
      }).owner;
  return found;
}

/// Entry for some samples, and their code length under it in nats, without their shares.
struct Described {
  DictionaryEntry entry;
  double length = 0;
};

/// The mean direction of the members, of RMS 1; empty where they cancel out.
Vector mean_shape(const std::vector<const Vector*>& members) {
  std::vector<double> sum(members[0]->size(), 0.0);
  for (const Vector* v : members)
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += double{(*v)[j]};
  double square = 0;
  for (const double s : sum) square += s * s;
  const double rms = std::sqrt(square / static_cast<double>(sum.size()));
  if (!(rms > 1e-6 * static_cast<double>(members.size()))) return {};
  Vector mean(sum.size());
  for (std::size_t j = 0; j < sum.size(); ++j) mean[j] = static_cast<float>(sum[j] / rms);
  return mean;
}

/// Covariance of the members about the mean.
cv::Mat1d covariance(const std::vector<const Vector*>& members, const Vector& mean) {
  const auto size = static_cast<int>(mean.size());
  cv::Mat1d sum(size, size, 0.0);
  std::vector<double> rest(mean.size());
  for (const Vector* v : members) {
    double along = 0;
    for (std::size_t j = 0; j < rest.size(); ++j) along += double{(*v)[j]} * double{mean[j]};
    along /= static_cast<double>(rest.size());
    for (std::size_t j = 0; j < rest.size(); ++j) rest[j] = double{(*v)[j]} - along * double{mean[j]};
    for (int a = 0; a < size; ++a) {
      double* row = sum[a];
      const double value = rest[static_cast<std::size_t>(a)];
      for (int b = 0; b <= a; ++b) row[b] += value * rest[static_cast<std::size_t>(b)];
    }
  }
  for (int a = 0; a < size; ++a)
    for (int b = 0; b <= a; ++b) sum(b, a) = sum(a, b) = sum(a, b) / static_cast<double>(members.size());
  return sum;
}

/// A row of eigenvectors as a component: RMS 1, what is greatest in it above 0.
Vector component(const cv::Mat1d& vectors, int k) {
  const int size = vectors.cols;
  int greatest = 0;
  for (int j = 1; j < size; ++j)
    if (std::abs(vectors(k, j)) > std::abs(vectors(k, greatest)) + 1e-9) greatest = j;
  const double scale = std::sqrt(static_cast<double>(size)) * (vectors(k, greatest) < 0 ? -1 : 1);
  Vector result;
  for (int j = 0; j < size; ++j) result.push_back(static_cast<float>(scale * vectors(k, j)));
  return result;
}

/// `numbers`: T, how many independent ones a view has beside level and contrast.
std::optional<Described> describe(const std::vector<const Vector*>& members, double numbers) {
  Described best;
  best.entry.mean = mean_shape(members);
  if (best.entry.mean.empty()) return std::nullopt;
  const cv::Mat1d spread = covariance(members, best.entry.mean);
  cv::Mat1d values, vectors;
  cv::eigen(spread, values, vectors);
  const double n = static_cast<double>(members.size()), size = static_cast<double>(spread.rows);
  // In units in which each of the T numbers has a variance of 1 where the view's RMS is 1.
  double rest = cv::trace(spread)[0] / size, logs = 0;
  std::size_t kept = 0;
  best.length = std::numeric_limits<double>::infinity();
  double left = rest;
  const std::size_t most = std::min(kMostComponents, members.size() / kLeastForEach);
  for (std::size_t k = 0; k <= most && static_cast<double>(k) < numbers - 1; ++k) {
    if (k > 0) {
      const double value = std::max(values(static_cast<int>(k) - 1), 0.0) / size;
      if (!(value * numbers > kLeastVariance)) break;
      logs += std::log(value * numbers);
      rest = std::max(rest - value, 0.0);
    }
    const double others = numbers - static_cast<double>(k);
    const double variance = std::max(rest * numbers / others, kLeastVariance);
    const double length = 0.5 * n * (logs + others * std::log(variance)) +
                          0.5 * std::log(n) * (static_cast<double>(k) + 1) * (numbers + 1);
    if (length < best.length) {
      best.length = length;
      kept = k;
      left = rest;
    }
  }
  best.entry.residual = std::sqrt(std::max(left, 0.0));
  for (std::size_t k = 0; k < kept; ++k) {
    best.entry.components.push_back(component(vectors, static_cast<int>(k)));
    best.entry.spread.push_back(std::sqrt(std::max(values(static_cast<int>(k)), 0.0) / size));
  }
  return best;
}

struct Description {
  std::vector<DictionaryEntry> entries;  // `seen`: members of the cluster
  double length = std::numeric_limits<double>::infinity();
};

std::optional<Description> describe_all(const std::vector<Vector>& samples, const Clustering& clustering,
                                        std::size_t count, double numbers) {
  Description all;
  all.length = 0;
  for (std::uint32_t c = 0; c < count; ++c) {
    std::vector<const Vector*> members;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (clustering.of_sample[i] == c) members.push_back(&samples[i]);
    if (members.empty() || (count > 1 && members.size() < kLeastMembers)) return std::nullopt;
    auto described = describe(members, numbers);
    if (!described) return std::nullopt;
    const double n = static_cast<double>(members.size());
    all.length += described->length - n * std::log(n / static_cast<double>(samples.size()));
    described->entry.seen = members.size();
    all.entries.push_back(std::move(described->entry));
  }
  return all;
}

std::vector<DictionaryEntry> learn_group(const std::vector<Vector>& samples, double numbers,
                                         std::uint64_t seed, int degree, graph::PatchType type) {
  Description best;
  for (std::size_t k = 1; k <= std::min(kMostEntries, samples.size()); ++k) {
    Clustering clustering;
    for (std::uint32_t start = 0; start < (k == 1 ? 1U : std::uint32_t{kStarts}); ++start) {
      const auto what = static_cast<std::uint32_t>(k * kStarts) + start;
      const auto group = static_cast<std::uint32_t>(degree * 256 + static_cast<int>(type));
      auto found = cluster(samples, k, core::Rng(seed, {group, what, kClustering}));
      if (found.squares < clustering.squares) clustering = std::move(found);
    }
    auto described = describe_all(samples, clustering, k, numbers);
    if (described && described->length < best.length) best = std::move(*described);
  }
  return best.entries;
}

double independent_numbers(bool window, double mean_reach, double mean_side) {
  const double pixels = window ? mean_side * mean_side : 2 * mean_reach + 1;
  const double most = window ? double{kWindowSide * kWindowSide} : double{kProfileSamples};
  return std::max(std::min(pixels, most) - 2, 1.0);
}

}  // namespace

void DictionaryLearner::add(std::uint32_t frame, std::span<const PatchView> views) {
  for (const PatchView& view : views) {
    const bool window = looks_like_window(view.type, view.degree);
    if (view.luma.empty()) continue;
    if (view.luma.size() != (window ? kWindowSide * kWindowSide : kProfileSamples))
      throw core::InputError("dictionary: a view has " + std::to_string(view.luma.size()) + " samples");
    if (normalised(view.luma).empty()) continue;
    Sample& sample = groups_[{view.degree, view.type}];
    ++sample.seen;
    core::Rng rng(seed_, {frame, view.vertex.value, kSampling});
    const std::uint64_t high = rng.bits();
    const Key key{high << 32U | rng.bits(), frame, view.vertex.value};
    const std::size_t most = window ? kMostWindows : kMostProfiles;
    if (sample.stored.size() == most && std::prev(sample.stored.end())->first < key) continue;
    sample.stored.insert_or_assign(key, view);
    if (sample.stored.size() > most) sample.stored.erase(std::prev(sample.stored.end()));
  }
}

std::size_t DictionaryLearner::stored() const {
  std::size_t count = 0;
  for (const auto& [group, sample] : groups_) count += sample.stored.size();
  return count;
}

Dictionary DictionaryLearner::learn(const core::Context& context) const {
  std::vector<const std::pair<const Group, Sample>*> groups;
  for (const auto& group : groups_) groups.push_back(&group);
  std::vector<std::vector<DictionaryEntry>> learned(groups.size());
  core::parallel_for(groups.size(), context, [&](std::size_t g) {
    const auto& [group, sample] = *groups[g];
    std::vector<Vector> samples;
    double reach = 0, side = 0;
    for (const auto& [key, view] : sample.stored) {
      samples.push_back(normalised(view.luma));
      reach += view.reach;
      side += 2 * window_reach(view) + 1;
    }
    const double n = static_cast<double>(samples.size());
    const bool window = looks_like_window(group.second, group.first);
    auto entries = learn_group(samples, independent_numbers(window, reach / n, side / n), seed_, group.first,
                               group.second);
    double total = 0;
    for (DictionaryEntry& entry : entries) {
      entry.degree = group.first;
      entry.type = group.second;
      const double seen = static_cast<double>(sample.seen) * static_cast<double>(entry.seen) / n;
      entry.seen = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(seen)));
      total += static_cast<double>(entry.seen);
    }
    for (DictionaryEntry& entry : entries) entry.share = static_cast<double>(entry.seen) / total;
    std::ranges::stable_sort(entries, std::greater{}, &DictionaryEntry::seen);
    learned[g] = std::move(entries);
  });
  Dictionary dictionary;
  for (auto& entries : learned)
    for (DictionaryEntry& entry : entries) dictionary.entries.push_back(std::move(entry));
  return dictionary;
}

}  // namespace emberfold::sketch
