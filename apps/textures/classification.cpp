// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/classification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/heat_matrix.hpp"
#include "core/error.hpp"

namespace emberfold::apps {

namespace {

using dytex::Measure;

// Accesses `pairs`, ordered as dytex::all_distances() returns them, by row and column.
class Pairs {
 public:
  Pairs(std::span<const dytex::Distances> pairs, std::size_t count) : pairs_(pairs), count_(count) {
    if (pairs.size() != count * (count + 1) / 2)
      throw core::InputError("cross_validate: " + std::to_string(pairs.size()) + " pairs are not those of " +
                             std::to_string(count) + " samples");
  }
  [[nodiscard]] const dytex::Distances& at(std::size_t i, std::size_t j) const {
    const auto [low, high] = std::minmax(i, j);
    return pairs_[low * count_ - low * (low + 1) / 2 + high];
  }
  // Returns whether the sample has distances by the measure.
  [[nodiscard]] bool has(std::size_t i, Measure measure) const { return dytex::has(at(i, i), measure); }

 private:
  std::span<const dytex::Distances> pairs_;
  std::size_t count_;
};

// Returns the dissimilarity of a pair by a measure that it has.
double distance_of(const dytex::Distances& pair, Measure measure) {
  return measure == Measure::kl ? *pair.kl + *pair.kl_back : distance(pair, measure);
}

// Returns d in the kernel exp(−d/s); nothing for the angles, which have their own kernel.
std::optional<double> exponent_of(const dytex::Distances& pair, Measure measure) {
  if (measure == Measure::kl) return distance_of(pair, measure);
  if (measure == Measure::angles) return std::nullopt;
  const double d = distance_of(pair, measure);
  return d * d;
}

double angles_kernel(const Pairs& pairs, std::size_t i, std::size_t j) {
  const auto states = [&](std::size_t k) { return static_cast<double>(pairs.at(k, k).angles.size()); };
  return pairs.at(i, j).angles.array().cos().square().sum() / std::sqrt(states(i) * states(j));
}

class TableKernel final : public cv::ml::SVM::Kernel {
 public:
  explicit TableKernel(cv::Mat1f table) : table_(std::move(table)) {}
  [[nodiscard]] int getType() const override { return cv::ml::SVM::CUSTOM; }
  // Samples are represented by their indices.
  void calc(int count, int, const float* samples, const float* other, float* results) override {
    for (int k = 0; k < count; ++k)
      results[k] = table_(static_cast<int>(samples[k]), static_cast<int>(other[0]));
  }

 private:
  cv::Mat1f table_;
};

// Computes the kernel of all samples; its scale comes from the training samples alone.
cv::Mat1f kernel_table(const Pairs& pairs, std::size_t count, std::span<const std::size_t> training,
                       Measure measure) {
  double scale = 1;
  if (measure != Measure::angles) {
    std::vector<double> all;
    for (const std::size_t i : training)
      for (const std::size_t j : training)
        if (i < j) all.push_back(*exponent_of(pairs.at(i, j), measure));
    if (!all.empty()) {
      const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
      std::ranges::nth_element(all, middle);
      if (*middle > 0 && std::isfinite(*middle)) scale = *middle;
    }
  }
  cv::Mat1f table(static_cast<int>(count), static_cast<int>(count), 0.0F);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i; j < count; ++j) {
      if (!dytex::has(pairs.at(i, j), measure)) continue;
      const auto exponent = exponent_of(pairs.at(i, j), measure);
      const double value = exponent ? std::exp(-*exponent / scale) : angles_kernel(pairs, i, j);
      table(static_cast<int>(i), static_cast<int>(j)) = table(static_cast<int>(j), static_cast<int>(i)) =
          static_cast<float>(value);
    }
  return table;
}

// Predicts the labels of the `asked` samples; all samples given have distances by the measure.
using Predict = std::function<void(std::span<const std::size_t> training, std::span<const std::size_t> asked,
                                   std::vector<std::optional<std::size_t>>& predicted)>;

Predict predict_by_nearest(const SampleLabels& samples, const Pairs& pairs, Measure measure) {
  return [&samples, &pairs, measure](auto training, auto asked, auto& predicted) {
    for (const std::size_t i : asked) {
      double least = std::numeric_limits<double>::infinity();
      predicted[i] = samples.label[training.front()];
      for (const std::size_t j : training)
        if (const double d = distance_of(pairs.at(i, j), measure); d < least)
          least = d, predicted[i] = samples.label[j];
    }
  };
}

Predict predict_by_svm(const SampleLabels& samples, const Pairs& pairs, Measure measure) {
  return [&samples, &pairs, measure](auto training, auto asked, auto& predicted) {
    constexpr double kCost = 10;
    const auto label_of = [&](std::size_t i) { return static_cast<int>(samples.label[i]); };
    cv::Mat1f numbers(static_cast<int>(training.size()), 1);
    cv::Mat1i labels(static_cast<int>(training.size()), 1);
    std::map<int, int> seen;  // number of samples by label
    for (int k = 0; k < numbers.rows; ++k) {
      const std::size_t i = training[static_cast<std::size_t>(k)];
      numbers(k, 0) = static_cast<float>(i);
      labels(k, 0) = label_of(i);
      ++seen[labels(k, 0)];
    }
    if (seen.size() < 2) {  // a single class
      for (const std::size_t i : asked) predicted[i] = samples.label[training.front()];
      return;
    }
    const auto machine = cv::ml::SVM::create();
    machine->setType(cv::ml::SVM::C_SVC);
    machine->setC(kCost);
    cv::Mat1d weights(static_cast<int>(seen.size()), 1);  // small classes have the same weight as large ones
    for (auto weight = weights.begin(); const auto& [label, count] : seen)
      *weight++ = double(numbers.rows) / (double(seen.size()) * count);
    machine->setClassWeights(weights);
    machine->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 100'000, 1e-6});
    machine->setCustomKernel(
        cv::makePtr<TableKernel>(kernel_table(pairs, samples.label.size(), training, measure)));
    machine->train(numbers, cv::ml::ROW_SAMPLE, labels);
    for (const std::size_t i : asked)
      predicted[i] = static_cast<std::size_t>(machine->predict(cv::Mat1f(1, 1, static_cast<float>(i))));
  };
}

Recognition evaluate_classifier(const SampleLabels& samples, const Pairs& pairs, Measure measure,
                                Classifier classifier) {
  const Predict predict = classifier == Classifier::nearest ? predict_by_nearest(samples, pairs, measure)
                                                            : predict_by_svm(samples, pairs, measure);
  Recognition result;
  result.measure = measure;
  result.classifier = classifier;
  result.predicted.resize(samples.label.size());
  const std::set<std::size_t> folds(samples.fold.begin(), samples.fold.end());
  for (const std::size_t fold : folds) {
    std::vector<std::size_t> training, asked;
    for (std::size_t i = 0; i < samples.fold.size(); ++i)
      if (pairs.has(i, measure)) (samples.fold[i] == fold ? asked : training).push_back(i);
    if (!training.empty()) predict(training, asked, result.predicted);
  }
  const int classes = static_cast<int>(samples.classes);
  result.confusion = cv::Mat::zeros(classes, classes, CV_64F);
  for (std::size_t i = 0; i < samples.label.size(); ++i) {
    if (!result.predicted[i]) continue;
    ++result.samples;
    result.confusion.at<double>(static_cast<int>(samples.label[i]), static_cast<int>(*result.predicted[i])) +=
        1;
  }
  if (result.samples > 0)
    result.accuracy = cv::trace(result.confusion)[0] / static_cast<double>(result.samples);
  return result;
}

}  // namespace

std::vector<std::size_t> deal_folds(std::span<const std::size_t> clip_labels, std::size_t folds) {
  const std::size_t clips = clip_labels.size();
  if (folds != 0 && (folds < 2 || folds > clips))
    throw core::InputError("folds is " + std::to_string(folds) +
                           ", allowed is 0 (a fold for every clip) and 2 to " + std::to_string(clips) +
                           ", the number of clips");
  std::vector<std::size_t> order(clips), dealt(clips);
  for (std::size_t i = 0; i < clips; ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return clip_labels[i]; });
  for (std::size_t k = 0; k < clips; ++k) dealt[order[k]] = folds == 0 ? order[k] : k % folds;
  return dealt;
}

const char* name(Classifier classifier) {
  return classifier == Classifier::nearest ? "nearest" : "svm";
}

std::vector<Recognition> cross_validate(const SampleLabels& samples,
                                        std::span<const dytex::Distances> distances) {
  const Pairs pairs(distances, samples.label.size());
  if (samples.fold.size() != samples.label.size() ||
      std::set(samples.fold.begin(), samples.fold.end()).size() < 2)
    throw core::InputError("cross_validate: every sample needs a fold, of two or more");
  std::vector<Recognition> results;
  for (const Classifier classifier : {Classifier::nearest, Classifier::svm})
    for (const Measure measure : dytex::kMeasures) {
      auto result = evaluate_classifier(samples, pairs, measure, classifier);
      if (result.samples > 0) results.push_back(std::move(result));
    }
  return results;
}

cv::Mat draw_recognition(const std::vector<std::string>& classes, std::span<const Recognition> results) {
  constexpr int kColumns = 5, kGap = 12;
  std::vector<cv::Mat> panels;
  cv::Size size;
  for (const auto& result : results) {
    std::array<char, 96> title{};
    std::snprintf(title.data(), title.size(), "%s, %s: %.1f %%", name(result.measure),
                  name(result.classifier), 100 * result.accuracy);
    panels.push_back(draw_heat_matrix({title.data(), classes, result.confusion, false, true, 480}));
    size.width = std::max(size.width, panels.back().cols);
    size.height = std::max(size.height, panels.back().rows);
  }
  const int count = static_cast<int>(panels.size()), columns = std::min(kColumns, std::max(1, count));
  const int rows = (count + columns - 1) / columns;
  cv::Mat picture(std::max(1, rows) * (size.height + kGap), columns * (size.width + kGap), CV_8UC3, kPaper);
  for (int i = 0; i < count; ++i) {
    const cv::Mat& panel = panels[static_cast<std::size_t>(i)];
    const cv::Point corner(i % columns * (size.width + kGap), i / columns * (size.height + kGap));
    panel.copyTo(picture(cv::Rect(corner, panel.size())));
  }
  return picture;
}

}  // namespace emberfold::apps
