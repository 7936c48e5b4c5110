// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::figures {

/// Events by what was said of them: how probable, and how many were true.
class Reliability {
 public:
  static constexpr std::size_t kBins = 10;
  struct Bin {
    double events = 0, said = 0, true_ones = 0;  ///< said: the sum of probabilities
  };

  /// Found events and true ones of a class are paired one to one within 2 frames and 20 px, as many as can
  /// be, among these the most probable. A true event that was not found at all counts as said to be
  /// impossible.
  void add(const std::vector<graph::Event>& truth, const std::vector<graph::Event>& found);

  [[nodiscard]] const std::array<Bin, kBins>& bins() const { return bins_; }
  [[nodiscard]] double events() const { return events_; }
  /// Returns the mean squared difference between probability and truth, and its expected value for calibrated
  /// probabilities. NaN where there is no event.
  [[nodiscard]] double brier() const { return squares_ / events_; }
  [[nodiscard]] double expected_brier() const { return variance_ / events_; }
  /// A bin's share of true events and its 90 % interval (Wilson 1927).
  struct Share {
    double share, low, high;
  };
  static Share share_of(const Bin& bin);

 private:
  void count(double probability, bool is_true);
  std::array<Bin, kBins> bins_{};
  double events_ = 0, squares_ = 0, variance_ = 0;
};

/// One line: the Brier scores, and of each bin that has events their number and the share of true ones.
void print(const std::string& name, const Reliability& reliability);

/// Shares of true events against what was said, a disc for each bin as large as it has events, as a PNG.
void draw(const Reliability& reliability, const std::filesystem::path& path);

}  // namespace emberfold::figures
