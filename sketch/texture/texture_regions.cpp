// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/texture_regions.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/math/kmeans.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "core/text/check_range.hpp"
#include "sketch/inpainting/check_levels.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::array<std::size_t, 6> kLimitEdges{2, 3, 5,
                                                 6, 8, 9};  // of each filter: 3, 12, 43, 57, 88, 97 %
constexpr int kLimits = kLimitEdges.size();
constexpr int kFeatures = kTextureFilters * kLimits;  // of a pixel
constexpr std::size_t kPaddedTo = 8;  // a feature is padded to whole vectors, as core::squared_distance sums
constexpr int kStep = 3;              // px between the pixels that make the clusters
constexpr int kIterations = 25;
constexpr int kReach = 3;  // px, of the filters
constexpr int kTries = 4;  // of k-means, the best is taken

using Feature = std::array<float, (kFeatures + kPaddedTo - 1) / kPaddedTo * kPaddedTo>;  // zeros behind

void check(const cv::Mat& levels, const cv::Mat& mask) {
  check_levels_and_mask("texture_regions", levels, mask);
  if (!cv::checkRange(levels))
    throw core::InputError("texture_regions: the levels hold a number that is not finite");
}

std::vector<int> where(const cv::Mat& responses, const cv::Mat& free) {
  std::vector<int> values;
  for (int y = 0; y < responses.rows; ++y)
    for (int x = 0; x < responses.cols; ++x)
      if (free.at<std::uint8_t>(y, x) != 0) values.push_back(responses.at<int>(y, x));
  return values;
}

/// The features of all pixels, rows × cols × kFeatures.
class Features {
 public:
  Features(const std::vector<cv::Mat>& responses, const std::array<BinEdges, kTextureFilters>& edges,
           const cv::Mat& free, int window)
      : planes_(kFeatures) {
    cv::Mat count;
    const cv::Size box(window, window);
    free.convertTo(count, CV_32F, 1.0 / 255);
    cv::boxFilter(count, count, CV_32F, box, {-1, -1}, false, cv::BORDER_CONSTANT);
    count = cv::max(count, 1);
    core::parallel_for(kFeatures, {}, [&](std::size_t i) {
      cv::Mat below = responses[i / kLimits] < edges[i / kLimits][kLimitEdges[i % kLimits]];
      below &= free;
      cv::Mat& plane = planes_[i];
      cv::boxFilter(below, plane, CV_32F, box, {-1, -1}, false, cv::BORDER_CONSTANT);
      plane = plane / (count * 255);
    });
    core::parallel_for(kTextureFilters, {}, [&](std::size_t f) { level_out(f * kLimits, free, window); });
  }
  [[nodiscard]] Feature at(int y, int x) const {
    Feature feature{};
    for (std::size_t i = 0; i < planes_.size(); ++i) feature[i] = planes_[i].at<float>(y, x);
    return feature;
  }

 private:
  /// Divides one filter's features by their usual difference between windows side by side. These lie mostly
  /// in one texture, so variation inside textures does not separate them.
  void level_out(std::size_t first, const cv::Mat& free, int window) {
    double sum = 0, pairs = 0;
    for (int y = 0; y < free.rows; y += kStep)
      for (int x = 0; x < free.cols; x += kStep)
        for (const cv::Point other : {cv::Point(x + window, y), cv::Point(x, y + window)}) {
          if (other.x >= free.cols || other.y >= free.rows || free.at<std::uint8_t>(y, x) == 0 ||
              free.at<std::uint8_t>(other) == 0)
            continue;
          ++pairs;
          for (std::size_t i = first; i < first + kLimits; ++i) {
            const auto d = static_cast<double>(planes_[i].at<float>(y, x) - planes_[i].at<float>(other));
            sum += d * d;
          }
        }
    if (!(sum > 0)) return;
    for (std::size_t i = first; i < first + kLimits; ++i) planes_[i] *= 0.1 / std::sqrt(sum / pairs);
  }

  std::vector<cv::Mat> planes_;
};

struct Clusters {
  std::vector<Feature> centres;
  double distortion = 0;  ///< mean squared distance
};

Clusters refine(const std::vector<Feature>& points, std::vector<Feature> centres) {
  auto state = core::lloyd(points, std::move(centres), kIterations,
                           [](const auto& assigned) { return !assigned.changed; });
  return {std::move(state.centres), state.squares / static_cast<double>(points.size())};
}

Clusters cluster(const std::vector<Feature>& points, int count, std::uint64_t seed) {
  std::vector<Clusters> tries(kTries);
  core::parallel_for(kTries, {}, [&](std::size_t i) {
    core::Rng rng(seed, {static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(i)});
    tries[i] = refine(points, core::kmeans_plus_plus(points, static_cast<std::size_t>(count), rng));
  });
  return *std::ranges::min_element(tries, {}, &Clusters::distortion);
}

/// (Σ λ)² / Σ λ² of the covariance's eigenvalues λ, from its entries.
double effective_dimension(const std::vector<Feature>& points) {
  cv::Mat samples(static_cast<int>(points.size()), static_cast<int>(points[0].size()), CV_32F), covariance,
      mean;
  for (std::size_t i = 0; i < points.size(); ++i)
    std::ranges::copy(points[i], samples.ptr<float>(static_cast<int>(i)));
  cv::calcCovarMatrix(samples, covariance, mean, cv::COVAR_NORMAL | cv::COVAR_ROWS | cv::COVAR_SCALE, CV_64F);
  const double trace = cv::trace(covariance)[0], square = covariance.dot(covariance);
  return square > 0 ? trace * trace / square : 1;
}

Clusters best_clusters(const std::vector<Feature>& points, const TextureOptions& options) {
  if (options.regions > 0) return cluster(points, options.regions, options.seed);
  const double power = -effective_dimension(points) / 2;
  Clusters best;
  double greatest = -1, reference = 0, before = 0;
  for (int count = std::max(1, options.fewest - 1); count <= options.most; ++count) {
    Clusters clusters = cluster(points, count, options.seed);
    const bool exact = !(clusters.distortion > 1e-12);
    if (reference <= 0) reference = std::max(clusters.distortion, 1e-12);
    const double now = std::pow(std::max(clusters.distortion, 1e-12) / reference, power);
    const double jump = count == 1 ? now : now - before;
    before = now;
    if (count < options.fewest && !exact) continue;
    if (jump > greatest) {
      greatest = jump;
      best = std::move(clusters);
    }
    if (exact) break;  // more would be empty
  }
  return best;
}

/// Assigns every free pixel and numbers the regions by mean level, leaving none empty.
void label_pixels(const Features& features, const cv::Mat& bytes, const cv::Mat& free,
                  const std::vector<Feature>& centres, TextureRegions& regions) {
  regions.label = cv::Mat(free.size(), CV_8U, cv::Scalar(0));
  core::parallel_for(static_cast<std::size_t>(free.rows), {}, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < free.cols; ++x)
      if (free.at<std::uint8_t>(y, x) != 0)
        regions.label.at<std::uint8_t>(y, x) =
            static_cast<std::uint8_t>(1 + core::nearest_centre(features.at(y, x), centres).first);
  });
  std::vector<std::pair<double, int>> order;  // mean level, label
  for (int k = 1; k <= static_cast<int>(centres.size()); ++k) {
    const cv::Mat own = regions.label == k;
    if (cv::countNonZero(own) > 0) order.emplace_back(cv::mean(bytes, own)[0], k);
  }
  std::ranges::sort(order);
  cv::Mat number(1, 256, CV_8U, cv::Scalar(0));
  for (std::size_t i = 0; i < order.size(); ++i)
    number.at<std::uint8_t>(order[i].second) = static_cast<std::uint8_t>(i + 1);
  cv::LUT(regions.label, number, regions.label);
  regions.count = static_cast<int>(order.size());
}

}  // namespace

void TextureOptions::validate() const {
  core::check_range("TextureOptions.regions", regions, 0, 16);
  core::check_range("TextureOptions.most", most, 1, 16);
  core::check_range("TextureOptions.fewest", fewest, 1, most);
  core::check_odd("TextureOptions.window", window, 3, 31);
}

TextureRegions segment_texture(const cv::Mat& levels, const cv::Mat& sketchable,
                               const TextureOptions& options) {
  options.validate();
  check(levels, sketchable);
  TextureRegions regions;
  regions.label = cv::Mat(levels.size(), CV_8U, cv::Scalar(0));
  regions.part = regions.label.clone();
  const cv::Mat free = sketchable == 0, bytes = core::to_bytes(core::luma(levels));
  if (cv::countNonZero(free) == 0) return regions;
  const auto filters = make_texture_filters();
  std::vector<cv::Mat> responses(filters.size());
  std::array<BinEdges, kTextureFilters> edges;
  core::parallel_for(filters.size(), {}, [&](std::size_t f) {
    responses[f] = filter_responses(bytes, filters[f]);
    edges[f] = make_bin_edges(where(responses[f], free));
  });
  const Features features(responses, edges, free, options.window);
  std::vector<Feature> points;
  for (const int step : {kStep, 1}) {  // a frame may be so small or covered that the grid misses all
    for (int y = step / 2; y < free.rows; y += step)
      for (int x = step / 2; x < free.cols; x += step)
        if (free.at<std::uint8_t>(y, x) != 0) points.push_back(features.at(y, x));
    if (!points.empty()) break;
  }
  label_pixels(features, bytes, free, best_clusters(points, options).centres, regions);
  cv::Mat beside;
  cv::dilate(sketchable != 0, beside, cv::Mat(2 * kReach + 1, 2 * kReach + 1, CV_8U, cv::Scalar(1)));
  regions.part = regions.label.clone();
  cv::add(regions.part, regions.count, regions.part, beside & free);
  regions.edges.resize(2 * static_cast<std::size_t>(regions.count));
  core::parallel_for(filters.size(), {}, [&](std::size_t f) {
    for (std::size_t k = 0; k < regions.edges.size(); ++k)
      regions.edges[k][f] = make_bin_edges(where(responses[f], regions.part == static_cast<int>(k + 1)));
  });
  regions.histograms = measure_region_histograms(bytes, regions);
  return regions;
}

std::vector<FilterHistograms> measure_region_histograms(const cv::Mat& bytes, const TextureRegions& regions) {
  std::vector<FilterHistograms> histograms(2 * static_cast<std::size_t>(regions.count));
  const auto filters = make_texture_filters();
  core::parallel_for(filters.size(), {}, [&](std::size_t f) {
    const cv::Mat responses = filter_responses(bytes, filters[f]);
    std::vector<double> counts(histograms.size(), 0.0);
    for (int y = 0; y < bytes.rows; ++y)
      for (int x = 0; x < bytes.cols; ++x) {
        const auto part = static_cast<std::size_t>(regions.part.at<std::uint8_t>(y, x));
        if (part == 0) continue;
        ++counts[part - 1];
        const int bin = find_bin(regions.edges[part - 1][f], responses.at<int>(y, x));
        ++histograms[part - 1][f][static_cast<std::size_t>(bin)];
      }
    for (std::size_t k = 0; k < histograms.size(); ++k)
      for (double& share : histograms[k][f]) share /= std::max(counts[k], 1.0);
  });
  return histograms;
}

}  // namespace emberfold::sketch
