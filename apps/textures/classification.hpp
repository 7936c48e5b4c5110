// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/distances/distances.hpp"

namespace emberfold::apps {

/// The fold of each clip, 0 … folds − 1: the clips of a class are dealt out one after another, so that
/// classes spread evenly. `folds` 0: every clip is a fold of its own. Draws nothing. core::InputError unless
/// folds is 0 or 2 … clips.
std::vector<std::size_t> deal_folds(std::span<const std::size_t> clip_labels, std::size_t folds);

/// What is known of each sample.
struct SampleLabels {
  std::vector<std::size_t> label, fold;  ///< one for each sample
  std::size_t classes = 0;
};

enum class Classifier { nearest, svm };
/// "nearest", "svm"
const char* name(Classifier classifier);

/// How one classifier did by one measure: every sample labelled by those of other folds.
struct Recognition {
  dytex::Measure measure = dytex::Measure::kl;
  Classifier classifier = Classifier::nearest;
  std::vector<std::size_t> predicted;  ///< of each sample
  cv::Mat confusion;                   ///< CV_64F, classes × classes: row is the truth, column what was told
  double accuracy = 0;                 ///< 0…1
};

/// Cross-validates. `pairs` is what dytex::all_distances() gave of the samples. Nearest: the label of the
/// nearest sample (KL: both ways added), the first of equals. SVM: OpenCV's, C = 10, one class against one,
/// with the kernels exp(−(KL + KL back)/s), exp(−Martin²/s), the normalised trace kernel, and Σ cos² θ / √(n
/// n′) of the subspace angles; s is the median over the pairs of training samples. Measures that a pair does
/// not have are left out. Draws nothing; the same at any thread count.
std::vector<Recognition> cross_validate(const SampleLabels& samples, std::span<const dytex::Distances> pairs);

/// All confusion matrices in one picture.
cv::Mat draw_recognition(const std::vector<std::string>& classes, std::span<const Recognition> results);

}  // namespace emberfold::apps
