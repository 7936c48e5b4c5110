// SPDX-License-Identifier: Apache-2.0
#include "graph/exporting/stroke_tree.hpp"

#include <map>
#include <set>
#include <utility>

#include "graph/io/curve_tables.hpp"

namespace emberfold::graph {

StrokeTree make_stroke_tree(const MotionGraph& motion, const std::vector<Event>& events) {
  StrokeTree tree;
  for (const auto& row : stroke_rows(motion))
    if (row.stroke > 0) tree.rows.push_back(row);
  std::map<std::uint32_t, std::size_t> first, last;
  for (std::size_t i = 0; i < tree.rows.size(); ++i) {
    const auto& row = tree.rows[i];
    first.emplace(row.stroke, i);
    last[row.stroke] = i;
    if (i > 0 && tree.rows[i - 1].stroke == row.stroke) tree.links.push_back({i - 1, i, 1, {}});
  }
  std::set<std::pair<std::size_t, std::size_t>> linked;
  for (const auto& event : events)
    for (const auto& before : event.before)
      for (const auto& after : event.after) {
        const auto from = last.find(before.value), to = first.find(after.value);
        if (from == last.end() || to == first.end()) continue;
        if (tree.rows[from->second].frame >= tree.rows[to->second].frame) continue;
        if (linked.emplace(from->second, to->second).second)
          tree.links.push_back({from->second, to->second, event.probability, std::string(name(event.type))});
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
