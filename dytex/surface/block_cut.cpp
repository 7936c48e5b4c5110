// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/block_cut.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/math/minimum_cut.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kLargestError = 1e6;
constexpr std::int32_t kNeverCut = 1'000'000'000;

}  // namespace

std::vector<bool> cut_cells(cv::Size block, const std::vector<CellState>& states,
                            std::span<const double> errors, std::span<const BorderCost> borders) {
  const std::size_t cells = states.size();
  const auto known = [&](std::size_t i) {
    return states[i] == CellState::there || states[i] == CellState::held;
  };
  double largest = 0;
  for (std::size_t i = 0; i < cells; ++i)
    if (known(i)) largest = std::max(largest, errors[i]);
  for (const auto& border : borders) largest = std::max({largest, border.there, border.own});
  const double scale = largest > 0 ? kLargestError / largest : 0;
  const auto whole = [&](double cost) { return static_cast<std::int32_t>(std::lround(scale * cost)); };
  core::MinimumCut cut(cells);
  const auto join = [&](std::size_t a, std::size_t b) {
    if (states[a] == CellState::outside || states[b] == CellState::outside || !(known(a) || known(b))) return;
    const double sum = errors[known(a) ? a : b] + errors[known(b) ? b : a];
    const std::int32_t cost = whole(sum) + 1;  // short seams of equal ones
    cut.add_edge(a, b, cost, cost);
  };
  const auto width = static_cast<std::size_t>(block.width);
  for (std::size_t i = 0; i < cells; ++i) {
    if (states[i] == CellState::empty) cut.add_costs(i, kNeverCut, 0);
    if (states[i] == CellState::held) cut.add_costs(i, 0, kNeverCut);
    if (!borders.empty() && states[i] != CellState::outside)
      cut.add_costs(i, whole(borders[i].there), whole(borders[i].own));
    if ((i + 1) % width != 0) join(i, i + 1);
    if (i + width < cells) join(i, i + width);
  }
  cut.solve();
  std::vector<bool> own(cells);
  for (std::size_t i = 0; i < cells; ++i) own[i] = states[i] != CellState::outside && cut.is_second(i);
  return own;
}

}  // namespace emberfold::dytex::detail
