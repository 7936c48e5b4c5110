// SPDX-License-Identifier: Apache-2.0
#include "graph/exporting/stroke_tree.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>

#include "graph/io/curve_tables.hpp"

namespace emberfold::graph {

StrokeTree make_stroke_tree(const MotionGraph& motion, const std::vector<Event>& events) {
  StrokeTree tree;
  for (const auto& row : stroke_rows(motion))
    if (row.stroke > 0) tree.rows.push_back(row);
  for (std::size_t i = 1; i < tree.rows.size(); ++i)
    if (tree.rows[i - 1].stroke == tree.rows[i].stroke) tree.links.push_back({i - 1, i, 1, {}});
  // Rows stand by stroke, then by frame.
  const auto first_from = [&](SubgraphId stroke, int frame) {
    return std::ranges::lower_bound(tree.rows, std::pair(stroke.value, static_cast<std::uint32_t>(frame)), {},
                                    [](const StrokeRow& row) { return std::pair(row.stroke, row.frame); });
  };
  std::set<std::pair<std::size_t, std::size_t>> linked;
  for (const auto& event : events)
    for (const auto& before : event.before)
      for (const auto& after : event.after) {
        if (before == after) continue;
        const auto next = first_from(before, event.frame), to = first_from(after, event.frame);
        if (next == tree.rows.begin() || to == tree.rows.end()) continue;
        const auto from = std::prev(next);
        if (from->stroke != before.value || to->stroke != after.value) continue;
        const std::pair ends(static_cast<std::size_t>(from - tree.rows.begin()),
                             static_cast<std::size_t>(to - tree.rows.begin()));
        if (linked.insert(ends).second)
          tree.links.push_back({ends.first, ends.second, event.probability, std::string(name(event.type))});
      }
  return tree;
}

StrokeTree make_curve_tree(const MotionGraph& motion) {
  StrokeTree tree;
  tree.of = "curve";
  for (const auto& row : curve_rows(motion))
    if (row.whole.stroke > 0) tree.rows.push_back(row.whole);
  for (std::size_t i = 1; i < tree.rows.size(); ++i)
    if (tree.rows[i - 1].stroke == tree.rows[i].stroke) tree.links.push_back({i - 1, i, 1, {}});
  return tree;
}

}  // namespace emberfold::graph
