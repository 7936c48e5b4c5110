// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/curve_alignment.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

namespace emberfold::graph::detail {

namespace {

constexpr double kSkipCost = 0.5;  // nats: cost of a skipped point, a ninth of the best gain of a link

using Places = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;

/// Lists for each vertex the curves that it lies on, and its place on them.
Places list_places(const std::vector<Curve>& curves, std::size_t size) {
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
      places_before_(list_places(before, size_before)),
      places_after_(list_places(after, size_after)) {}

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

IndexLinks Aligner::align_greedily() {
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
    alignments[p] = best_alignment(pairs_[p]);
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

Aligner::Alignment Aligner::best_alignment(const Pair& pair) const {
  Alignment there = best_alignment(pair, false), back = best_alignment(pair, true);
  return there.gain >= back.gain ? there : back;
}

namespace {

enum class Step : unsigned char { stop, match, skip_before, skip_after, start };

/// A table that stores only the columns [low, high] of each row; it is 0 elsewhere.
class BandedTable {
 public:
  struct Place {
    std::int64_t i = 0, j = 0;
  };

  /// Spans the rows and columns of the places, which are sorted by row.
  explicit BandedTable(const std::vector<Place>& places) : first_(places.front().i) {
    const auto rows = static_cast<std::size_t>(places.back().i - first_ + 1);
    low_.assign(rows, 1);  // an empty row
    high_.assign(rows, 0);
    for (const Place& place : places) {
      const auto r = static_cast<std::size_t>(place.i - first_);
      const bool empty = low_[r] > high_[r];
      low_[r] = empty ? place.j : std::min(low_[r], place.j);
      high_[r] = empty ? place.j : std::max(high_[r], place.j);
    }
    offset_.push_back(0);
    for (std::size_t r = 0; r < rows; ++r) {
      offset_.push_back(offset_.back() + static_cast<std::size_t>(high_[r] - low_[r] + 1));
    }
    own_.assign(offset_.back(), 0);
    gain_.assign(offset_.back(), 0);
    step_.assign(offset_.back(), Step::stop);
  }

  void set_candidate(Place place, double gain) { own_[static_cast<std::size_t>(find(place))] = gain; }

  /// Computes the best gain of an alignment that ends at each place; returns the end of the best one.
  Place fill() {
    Place top{first_, low_[0]};
    for (std::size_t r = 0; r < low_.size(); ++r) {
      for (std::int64_t j = low_[r]; j <= high_[r]; ++j) {
        const Place here{first_ + static_cast<std::int64_t>(r), j};
        fill(here);
        if (gain(here) > gain(top)) top = here;
      }
    }
    return top;
  }

  [[nodiscard]] double gain(Place place) const {
    const std::ptrdiff_t k = find(place);
    return k < 0 ? 0 : gain_[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] Step step(Place place) const {
    const std::ptrdiff_t k = find(place);
    return k < 0 ? Step::stop : step_[static_cast<std::size_t>(k)];
  }

 private:
  [[nodiscard]] std::ptrdiff_t find(Place place) const {
    const std::int64_t row = place.i - first_;
    if (row < 0 || row >= static_cast<std::int64_t>(low_.size())) return -1;
    const auto r = static_cast<std::size_t>(row);
    if (place.j < low_[r] || place.j > high_[r]) return -1;
    return static_cast<std::ptrdiff_t>(offset_[r]) + (place.j - low_[r]);
  }

  void fill(Place here) {
    const auto k = static_cast<std::size_t>(find(here));
    if (own_[k] > 0) {
      const double so_far = gain({here.i - 1, here.j - 1});
      gain_[k] = so_far + own_[k];
      step_[k] = so_far > 0 ? Step::match : Step::start;
    }
    const double up = gain({here.i - 1, here.j}) - kSkipCost, left = gain({here.i, here.j - 1}) - kSkipCost;
    if (up > gain_[k]) gain_[k] = up, step_[k] = Step::skip_before;
    if (left > gain_[k]) gain_[k] = left, step_[k] = Step::skip_after;
  }

  std::int64_t first_;
  std::vector<std::int64_t> low_, high_;
  std::vector<std::size_t> offset_;
  std::vector<double> own_, gain_;  // own_: gain of the place itself, 0 if it is no candidate
  std::vector<Step> step_;
};

}  // namespace

Aligner::Alignment Aligner::best_alignment(const Pair& pair, bool backwards) const {
  const Curve &a = before_[pair.curve_before], &b = after_[pair.curve_after];
  const auto last = static_cast<std::int64_t>(b.size()) - 1;
  std::vector<BandedTable::Place> places;
  for (const Cell& cell : pair.cells)
    places.push_back({cell.i, backwards ? last - cell.j : std::int64_t{cell.j}});
  BandedTable band(places);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Cell& cell = pair.cells[k];
    if (!used_before_[a[cell.i]] && !used_after_[b[cell.j]]) band.set_candidate(places[k], cell.gain);
  }
  BandedTable::Place at = band.fill();
  Alignment result;
  result.gain = band.gain(at);
  for (Step step = band.step(at); step != Step::stop; step = band.step(at)) {
    if (step == Step::match || step == Step::start) {
      const auto on_b = static_cast<std::size_t>(backwards ? last - at.j : at.j);
      result.links.emplace_back(a[static_cast<std::size_t>(at.i)], b[on_b]);
    }
    if (step == Step::start) break;
    if (step != Step::skip_after) --at.i;
    if (step != Step::skip_before) --at.j;
  }
  return result;
}

}  // namespace emberfold::graph::detail
