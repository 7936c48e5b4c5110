// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/distances/distances.hpp"

namespace emberfold::apps {

/// Assigns clips to folds 0 … folds − 1, cyclically within each class, so that classes spread evenly. `folds`
/// 0: every clip is its own fold. Deterministic. Throws core::InputError unless folds is 0 or 2 … clips.
std::vector<std::size_t> deal_folds(std::span<const std::size_t> clip_labels, std::size_t folds);

/// The class and fold of each sample.
struct SampleLabels {
  std::vector<std::size_t> label, fold;  ///< one for each sample
  std::size_t classes = 0;
};

enum class Classifier { nearest, svm };
/// Returns "nearest" or "svm".
const char* name(Classifier classifier);

/// The result of one classifier with one measure; each sample is labelled from the other folds.
struct Recognition {
  dytex::Measure measure = dytex::Measure::kl;
  Classifier classifier = Classifier::nearest;
  /// By sample; none where it, or every sample of other folds, lacks the distance.
  std::vector<std::optional<std::size_t>> predicted;
  std::size_t samples = 0;  ///< with a prediction
  cv::Mat confusion;        ///< CV_64F, classes × classes: rows are true, columns predicted classes
  double accuracy = 0;      ///< 0…1, of these samples
};

/// Cross-validates both classifiers with every measure. `pairs`: from dytex::all_distances() of the samples.
/// Nearest: the label of the nearest sample (KL: both directions added), the first of ties. SVM: OpenCV's, C
/// = 10, one class against another. Its kernels are exp(−(KL + KL back)/s), exp(−Martin²/s), Σ cos² θ / √(n
/// n′) of the subspace angles, and exp(−windows²/s); s is the median over pairs of training samples. Omits
/// samples from measures that they lack (KL without noise r, angles without components, windows where none
/// moves), and measures that can classify no sample. Deterministic, the same at any thread count.
std::vector<Recognition> cross_validate(const SampleLabels& samples, std::span<const dytex::Distances> pairs);

/// Draws all confusion matrices in one picture.
cv::Mat draw_recognition(const std::vector<std::string>& classes, std::span<const Recognition> results);

}  // namespace emberfold::apps
