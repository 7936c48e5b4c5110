// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/events/joints.hpp"
#include "graph/io/motion_io.hpp"

namespace emberfold::graph {

namespace {

struct Row {
  std::uint32_t stroke = 0, frame = 0, patches = 0, ends = 0, junctions = 0;
  Point middle;
  double length = 0, width = 0, contrast = 0;
};

/// Returns a row for each component, by its lowest vertex.
std::vector<Row> rows_of(const AttributeGraph& graph, std::uint32_t frame) {
  const Components parts = components(graph);
  std::vector<Row> rows(parts.count);
  std::vector<std::uint32_t> member(parts.count);
  for (std::size_t i = graph.size(); i-- > 0;) member[parts.of_vertex[i]] = static_cast<std::uint32_t>(i);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    Row& row = rows[parts.of_vertex[i]];
    const Patch& patch = graph.patch(i);
    ++row.patches;
    row.ends += graph.degree(i) == 1 ? 1 : 0;
    row.junctions += graph.degree(i) >= 3 ? 1 : 0;
    row.width += patch.width;
    row.contrast += patch.contrast;
    for (const std::uint32_t other : graph.neighbours(i))
      if (other > i) row.length += distance(patch.position, graph.patch(other).position);
  }
  detail::ShortestPaths paths(graph);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Row& row = rows[k];
    row.stroke = graph.vertices()[member[k]].subgraph.value;
    row.frame = frame;
    row.middle = detail::component_middle(graph, paths, member[k]);
    row.width /= row.patches;
    row.contrast /= row.patches;
  }
  return rows;
}

}  // namespace

void write_strokes(std::ostream& out, const MotionGraph& motion) {
  std::vector<Row> rows;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    const auto more = rows_of(motion.sketch.frames[t], static_cast<std::uint32_t>(t));
    rows.insert(rows.end(), more.begin(), more.end());
  }
  std::ranges::stable_sort(rows, {}, &Row::stroke);
  std::string text = "stroke,frame,x,y,length,patches,width,contrast,ends,junctions\n";
  for (const Row& row : rows) {
    core::append_number(text, row.stroke);
    const auto column = [&text](auto value) {
      text += ',';
      core::append_number(text, value);
    };
    column(row.frame);
    column(row.middle.x);
    column(row.middle.y);
    column(row.length);
    column(row.patches);
    column(row.width);
    column(row.contrast);
    column(row.ends);
    column(row.junctions);
    text += '\n';
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("strokes could not be written: the stream failed");
}

}  // namespace emberfold::graph
