// SPDX-License-Identifier: Apache-2.0
#include "graph/align.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

namespace emberfold::graph::detail {

namespace {

constexpr double kSkip = 0.5;  // what a point costs that is passed over

using Places = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;

/// Of each vertex the curves that it lies on, and where.
Places places(const std::vector<Curve>& curves, std::size_t size) {
  Places result(size);
  for (std::uint32_t c = 0; c < curves.size(); ++c) {
    const bool ring = curves[c].size() > 1 && curves[c].front() == curves[c].back();
    const auto count = static_cast<std::uint32_t>(curves[c].size() - (ring ? 1 : 0));
    for (std::uint32_t k = 0; k < count; ++k) result[curves[c][k]].emplace_back(c, k);
  }
  return result;
}

}  // namespace

Aligner::Aligner(const std::vector<Curve>& before, const std::vector<Curve>& after, std::size_t size_before,
                 std::size_t size_after)
    : before_(before),
      after_(after),
      places_before_(places(before, size_before)),
      places_after_(places(after, size_after)) {}

void Aligner::collect(const std::vector<Candidate>& candidates) {
  using Entry = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, double>;
  std::vector<Entry> entries;
  for (const Candidate& candidate : candidates) {
    for (const auto& [a, i] : places_before_[candidate.row]) {
      for (const auto& [b, j] : places_after_[candidate.column])
        entries.emplace_back(a, b, i, j, candidate.gain);
    }
  }
  std::sort(entries.begin(), entries.end());
  pairs_.clear();
  for (const auto& [a, b, i, j, gain] : entries) {
    if (pairs_.empty() || pairs_.back().curve_before != a || pairs_.back().curve_after != b) {
      pairs_.push_back({a, b, 1, {}});
    }
    pairs_.back().cells.push_back({i, j, gain});
  }
}

IndexLinks Aligner::greedy() {
  used_before_.assign(places_before_.size(), false);
  used_after_.assign(places_after_.size(), false);
  struct Entry {
    double gain;
    std::uint32_t pair;
    bool operator<(const Entry& other) const {
      return gain != other.gain ? gain < other.gain : pair > other.pair;
    }
  };
  std::priority_queue<Entry> queue;
  std::vector<Alignment> alignments(pairs_.size());
  const auto offer = [&](std::uint32_t p) {
    alignments[p] = best(pairs_[p]);
    const bool short_one =
        before_[pairs_[p].curve_before].size() == 1 || after_[pairs_[p].curve_after].size() == 1;
    if (alignments[p].links.size() >= (short_one ? 1U : 2U))
      queue.push({alignments[p].gain * pairs_[p].weight, p});
  };
  for (std::uint32_t p = 0; p < pairs_.size(); ++p) offer(p);
  IndexLinks result;
  while (!queue.empty()) {
    const std::uint32_t p = queue.top().pair;
    queue.pop();
    const IndexLinks& links = alignments[p].links;
    const bool free = std::none_of(links.begin(), links.end(), [&](const auto& link) {
      return used_before_[link.first] || used_after_[link.second];
    });
    if (free) {
      for (const auto& [i, j] : links) {
        used_before_[i] = used_after_[j] = true;
        result.emplace_back(i, j);
      }
    }
    offer(p);
  }
  std::sort(result.begin(), result.end());
  return result;
}

Aligner::Alignment Aligner::best(const Pair& pair) const {
  Alignment there = best(pair, false), back = best(pair, true);
  return there.gain >= back.gain ? there : back;
}

namespace {

enum class Step : unsigned char { stop, match, skip_before, skip_after, start };

/// The rows of a table of which only the columns [low, high] of each row are there.
struct Band {
  std::uint32_t first = 0;  ///< row
  std::vector<std::uint32_t> low, high;
  std::vector<std::size_t> offset;
  std::vector<double> gain;
  std::vector<Step> step;

  [[nodiscard]] std::ptrdiff_t find(std::int64_t i, std::int64_t j) const {
    const std::int64_t row = i - first;
    if (row < 0 || row >= static_cast<std::int64_t>(low.size())) return -1;
    const auto r = static_cast<std::size_t>(row);
    if (j < low[r] || j > high[r]) return -1;
    return static_cast<std::ptrdiff_t>(offset[r]) + (j - low[r]);
  }
};

}  // namespace

Aligner::Alignment Aligner::best(const Pair& pair, bool backwards) const {
  const Curve &a = before_[pair.curve_before], &b = after_[pair.curve_after];
  const auto last = static_cast<std::uint32_t>(b.size() - 1);
  const auto column = [&](const Cell& cell) { return backwards ? last - cell.j : cell.j; };
  Band band;
  band.first = pair.cells.front().i;
  const std::size_t rows = pair.cells.back().i - band.first + 1;
  band.low.assign(rows, 1);  // an empty row
  band.high.assign(rows, 0);
  for (const Cell& cell : pair.cells) {
    const std::size_t r = cell.i - band.first;
    const std::uint32_t j = column(cell);
    const bool empty = band.low[r] > band.high[r];
    band.low[r] = empty ? j : std::min(band.low[r], j);
    band.high[r] = empty ? j : std::max(band.high[r], j);
  }
  std::size_t size = 0;
  for (std::size_t r = 0; r < rows; ++r) {
    band.offset.push_back(size);
    size += band.high[r] + 1 - band.low[r];
  }
  std::vector<double> cell_gain(size, 0);  // 0: no candidate
  for (const Cell& cell : pair.cells) {
    if (used_before_[a[cell.i]] || used_after_[b[cell.j]]) continue;
    cell_gain[static_cast<std::size_t>(band.find(cell.i, column(cell)))] = cell.gain;
  }

  band.gain.assign(size, 0);
  band.step.assign(size, Step::stop);
  std::size_t top = 0, at = 0;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::uint32_t j = band.low[r]; j <= band.high[r] && band.low[r] <= band.high[r]; ++j, ++at) {
      const std::int64_t i = static_cast<std::int64_t>(band.first + r);
      const auto value = [&](std::ptrdiff_t k) {
        return k < 0 ? 0.0 : band.gain[static_cast<std::size_t>(k)];
      };
      if (cell_gain[at] > 0) {
        const double before = value(band.find(i - 1, std::int64_t{j} - 1));
        band.gain[at] = before + cell_gain[at];
        band.step[at] = before > 0 ? Step::match : Step::start;
      }
      const double up = value(band.find(i - 1, j)) - kSkip,
                   left = value(band.find(i, std::int64_t{j} - 1)) - kSkip;
      if (up > band.gain[at]) band.gain[at] = up, band.step[at] = Step::skip_before;
      if (left > band.gain[at]) band.gain[at] = left, band.step[at] = Step::skip_after;
      if (band.gain[at] > band.gain[top]) top = at;
    }
  }
  Alignment result;
  if (size == 0 || band.gain[top] <= 0) return result;
  result.gain = band.gain[top];
  const auto row = std::upper_bound(band.offset.begin(), band.offset.end(), top) - band.offset.begin() - 1;
  auto r = static_cast<std::size_t>(row);
  while (band.low[r] > band.high[r]) --r;
  std::int64_t i = static_cast<std::int64_t>(band.first + r);
  std::int64_t j = band.low[r] + static_cast<std::int64_t>(top - band.offset[r]);
  for (std::ptrdiff_t k = band.find(i, j); k >= 0; k = band.find(i, j)) {
    const Step step = band.step[static_cast<std::size_t>(k)];
    if (step == Step::stop) break;
    if (step == Step::match || step == Step::start) {
      const auto on_b = static_cast<std::size_t>(backwards ? std::int64_t{last} - j : j);
      result.links.emplace_back(a[static_cast<std::size_t>(i)], b[on_b]);
      --i, --j;
      if (step == Step::start) break;
    } else if (step == Step::skip_before) {
      --i;
    } else {
      --j;
    }
  }
  return result;
}

}  // namespace emberfold::graph::detail
