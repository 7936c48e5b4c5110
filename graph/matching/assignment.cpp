// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include <boost/pending/disjoint_sets.hpp>

#include "core/error.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::graph {

namespace {

/// Solves an assignment with rows ≤ columns, adding row after row along the shortest augmenting path.
class AugmentingPaths {
 public:
  AugmentingPaths(std::size_t rows, std::size_t columns, std::span<const double> cost)
      : columns_(columns),
        cost_(cost),
        row_price_(rows, 0),
        column_price_(columns, 0),
        row_of_(columns, kUnassigned) {}

  void add(std::size_t row) {
    std::vector<double> shortest(columns_, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> via(columns_, kUnassigned);  // the column before, on the path to this one
    std::vector<bool> done(columns_, false);
    std::size_t from = kUnassigned, i = row;
    double length = 0;
    for (;;) {
      std::size_t nearest = kUnassigned;
      for (std::size_t j = 0; j < columns_; ++j) {
        if (done[j]) continue;
        const double through = length + cost_[i * columns_ + j] - row_price_[i] - column_price_[j];
        if (through < shortest[j]) {
          shortest[j] = through;
          via[j] = from;
        }
        if (nearest == kUnassigned || shortest[j] < shortest[nearest]) nearest = j;
      }
      length = shortest[nearest];
      done[nearest] = true;
      from = nearest;
      if (row_of_[nearest] == kUnassigned) break;
      i = row_of_[nearest];
    }
    row_price_[row] += length;
    for (std::size_t j = 0; j < columns_; ++j) {
      if (!done[j] || j == from) continue;
      row_price_[row_of_[j]] += length - shortest[j];
      column_price_[j] -= length - shortest[j];
    }
    for (std::size_t j = from; j != kUnassigned; j = via[j]) {
      row_of_[j] = via[j] == kUnassigned ? row : row_of_[via[j]];
    }
  }

  [[nodiscard]] const std::vector<std::size_t>& row_of() const { return row_of_; }

 private:
  std::size_t columns_;
  std::span<const double> cost_;
  std::vector<double> row_price_, column_price_;
  std::vector<std::size_t> row_of_;
};

}  // namespace

std::vector<std::size_t> assign(std::size_t rows, std::size_t columns, std::span<const double> cost) {
  if (cost.size() != rows * columns) {
    throw core::InputError("assignment: " + std::to_string(cost.size()) + " costs for " +
                           std::to_string(rows) + " rows and " + std::to_string(columns) + " columns");
  }
  if (!std::all_of(cost.begin(), cost.end(), [](double value) { return std::isfinite(value); })) {
    throw core::InputError("assignment: a cost is not finite");
  }
  std::vector<std::size_t> result(rows, kUnassigned);
  if (rows <= columns) {
    AugmentingPaths paths(rows, columns, cost);
    for (std::size_t i = 0; i < rows; ++i) paths.add(i);
    for (std::size_t j = 0; j < columns; ++j) {
      if (paths.row_of()[j] != kUnassigned) result[paths.row_of()[j]] = j;
    }
    return result;
  }
  std::vector<double> transposed(cost.size());
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) transposed[j * rows + i] = cost[i * columns + j];
  }
  AugmentingPaths paths(columns, rows, transposed);
  for (std::size_t j = 0; j < columns; ++j) paths.add(j);
  for (std::size_t i = 0; i < rows; ++i) result[i] = paths.row_of()[i];
  return result;
}

namespace {

/// Returns the values sorted, each once.
std::vector<std::uint32_t> distinct(std::vector<std::uint32_t> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::size_t position_in(const std::vector<std::uint32_t>& sorted, std::uint32_t value) {
  return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

/// The rows and the columns of the candidates.
struct Sides {
  std::vector<std::uint32_t> rows, columns;

  explicit Sides(std::span<const Candidate> candidates) {
    for (const Candidate& c : candidates) rows.push_back(c.row), columns.push_back(c.column);
    rows = distinct(std::move(rows));
    columns = distinct(std::move(columns));
  }
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> assign(std::span<const Candidate> candidates) {
  const Sides all(candidates);
  const std::size_t nodes = all.rows.size() + all.columns.size();
  std::vector<std::size_t> rank(nodes), parent(nodes);
  boost::disjoint_sets sets(rank.data(), parent.data());
  for (std::size_t k = 0; k < nodes; ++k) sets.make_set(k);
  for (const Candidate& c : candidates) {
    core::check_positive("Candidate.gain", c.gain);
    sets.union_set(position_in(all.rows, c.row), all.rows.size() + position_in(all.columns, c.column));
  }
  std::map<std::size_t, std::vector<Candidate>> groups;
  for (const Candidate& c : candidates) groups[sets.find_set(position_in(all.rows, c.row))].push_back(c);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  std::vector<double> cost;
  for (const auto& [root, group] : groups) {
    const Sides sides(group);
    const std::size_t columns = sides.columns.size();
    cost.assign(sides.rows.size() * columns, 0);
    for (const Candidate& c : group)
      cost[position_in(sides.rows, c.row) * columns + position_in(sides.columns, c.column)] = -c.gain;
    const auto column_of = assign(sides.rows.size(), columns, cost);
    for (std::size_t i = 0; i < sides.rows.size(); ++i) {
      if (column_of[i] == kUnassigned || cost[i * columns + column_of[i]] == 0) continue;
      result.emplace_back(sides.rows[i], sides.columns[column_of[i]]);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace emberfold::graph
