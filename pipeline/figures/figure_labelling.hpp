// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace emberfold::pipeline {

/// Units that meet: what is whole in one frame is parts in the next one, or in the one before.
struct LabelStar {
  std::size_t whole = 0;
  std::vector<std::size_t> parts;
};

/// A labelling of units by 0 and 1. Its energy is change · changes − Σ gain(i) x(i). A star counts as many
/// changes as its parts of label 1 differ in number from its whole (from 1 where the whole is 1).
struct Labelling {
  std::vector<double> gain;
  double change = 0;
  std::vector<LabelStar> stars;
};

/// Returns labels of low energy: the minimum cut (Boykov & Kolmogorov 2004) of the energy in which each part
/// of a star that differs from its whole is a change, then single changes of labels as long as one lowers the
/// energy itself. Exact where stars have one part.
std::vector<char> best_labels(const Labelling& of);

}  // namespace emberfold::pipeline
