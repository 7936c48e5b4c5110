// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "graph/curves/curve_strokes.hpp"
#include "graph/events/joints.hpp"
#include "graph/io/curve_tables.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/table_text.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

namespace {

using Row = StrokeRow;

/// Returns a row for each piece of a stroke, by its lowest vertex.
std::vector<Row> rows_of(const AttributeGraph& whole, std::uint32_t frame) {
  const AttributeGraph graph = without_touches(whole);
  const Components parts = components(graph);
  std::vector<Row> rows(parts.count);
  std::vector<std::uint32_t> member(parts.count);
  for (std::size_t i = graph.size(); i-- > 0;) member[parts.of_vertex[i]] = static_cast<std::uint32_t>(i);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    Row& row = rows[parts.of_vertex[i]];
    const Patch& patch = graph.patch(i);
    ++row.patches;
    row.ends += whole.degree(i) == 1 ? 1 : 0;
    row.junctions += whole.degree(i) >= 3 ? 1 : 0;
    row.width += patch.width;
    row.contrast += patch.contrast;
    for (const std::uint32_t other : graph.neighbours(i))
      if (other > i && is_seen(patch, graph.patch(other)))
        row.length += distance(patch.position, graph.patch(other).position);
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

/// Makes one row of a stroke's pieces in a frame; patches of no stroke stay a row for each component.
std::vector<Row> join_pieces(const std::vector<Row>& pieces) {
  std::vector<Row> rows;
  double longest = 0;
  for (const Row& piece : pieces) {
    if (piece.stroke == 0 || rows.empty() || rows.back().stroke != piece.stroke ||
        rows.back().frame != piece.frame) {
      rows.push_back(piece);
      longest = piece.length;
      continue;
    }
    Row& row = rows.back();
    const double patches = row.patches + piece.patches;
    row.width = (row.width * row.patches + piece.width * piece.patches) / patches;
    row.contrast = (row.contrast * row.patches + piece.contrast * piece.patches) / patches;
    if (piece.length > longest) row.middle = piece.middle, longest = piece.length;
    row.patches += piece.patches, row.length += piece.length;
    row.ends += piece.ends, row.junctions += piece.junctions;
    ++row.pieces;
  }
  return rows;
}

/// The slope of lengths over frames, by least squares.
double slope(std::span<const Row> rows) {
  double mean_t = 0, mean_length = 0, product = 0, square = 0;
  for (const Row& row : rows) mean_t += row.frame, mean_length += row.length;
  mean_t /= static_cast<double>(rows.size()), mean_length /= static_cast<double>(rows.size());
  for (const Row& row : rows) {
    product += (row.frame - mean_t) * (row.length - mean_length);
    square += (row.frame - mean_t) * (row.frame - mean_t);
  }
  return square > 0 ? product / square : 0;
}

StrokeLife life_of(std::span<const Row> rows, std::size_t clip_frames) {
  StrokeLife life;
  life.stroke = rows.front().stroke;
  life.first = static_cast<int>(rows.front().frame), life.last = static_cast<int>(rows.back().frame);
  life.whole = life.first > 0 && static_cast<std::size_t>(life.last) + 1 < clip_frames;
  double way = 0;
  int steps = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    life.length += rows[i].length / static_cast<double>(rows.size());
    if (i == 0 || rows[i].frame != rows[i - 1].frame + 1) continue;
    way += distance(rows[i].middle, rows[i - 1].middle);
    ++steps;
  }
  life.speed = steps > 0 ? way / steps : 0;
  life.growth = slope(rows);
  return life;
}

/// Returns how many edges lead from each curve to others, by (curve, frame).
std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> touches_of(const MotionGraph& motion) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> touches;
  for (std::uint32_t t = 0; t < motion.sketch.frames.size(); ++t) {
    const AttributeGraph& graph = motion.sketch.frames[t];
    for (const Edge& edge : graph.edges()) {
      const CurveId a = graph.vertices()[graph.index_of(edge.a)].curve,
                    b = graph.vertices()[graph.index_of(edge.b)].curve;
      if (a != b) ++touches[{a.value, t}], ++touches[{b.value, t}];
    }
  }
  return touches;
}

void begin_row(detail::TableLine& line, const Row& row) {
  line.add(row.stroke), line.add(row.frame);
  line.add_place(row.middle), line.add(row.length);
  line.add(row.patches);
  line.add(row.width), line.add(row.contrast);
}

void end_row(detail::TableLine& line, const Row& row) {
  line.add_time(static_cast<int>(row.frame));
  line.add_place_um(row.middle), line.add_length_um(row.length);
  line.end();
}

}  // namespace

std::vector<CurveRow> curve_rows(const MotionGraph& motion) {
  std::vector<CurveRow> rows;
  for (const Row& row : stroke_rows(curves_as_strokes(motion))) rows.push_back({row});
  const auto touches = touches_of(motion);
  for (CurveRow& row : rows) {
    const auto at = touches.find({row.whole.stroke, row.whole.frame});
    if (at != touches.end()) row.touches = at->second;
  }
  return rows;
}

void write_curves(std::ostream& out, const MotionGraph& motion, const Units& units) {
  std::string text = "curve,frame,x,y,length,patches,width,contrast,pieces,touches";
  detail::end_head(text, units, ",time_s", ",x_um,y_um,length_um");
  for (const auto& [row, touches] : curve_rows(motion)) {
    detail::TableLine line(text, units);
    begin_row(line, row);
    line.add(row.pieces), line.add(touches);
    end_row(line, row);
  }
  detail::write_table(out, text);
}

void write_joints(std::ostream& out, const std::vector<CurveJoint>& joints, const Units& units) {
  std::string text = "frame,x,y,curve_a,curve_b,junction,probability";
  detail::end_head(text, units, ",time_s", ",x_um,y_um");
  for (const CurveJoint& joint : joints) {
    detail::TableLine line(text, units);
    line.add(static_cast<std::uint32_t>(joint.frame));
    line.add_place(joint.position);
    line.add(joint.a.value), line.add(joint.b.value);
    line.add(static_cast<std::uint32_t>(joint.at_junction)), line.add(joint.probability);
    line.add_time(joint.frame), line.add_place_um(joint.position);
    line.end();
  }
  detail::write_table(out, text);
}

std::vector<StrokeRow> stroke_rows(const MotionGraph& motion) {
  std::vector<StrokeRow> rows;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    const auto more = rows_of(motion.sketch.frames[t], static_cast<std::uint32_t>(t));
    rows.insert(rows.end(), more.begin(), more.end());
  }
  std::ranges::stable_sort(rows, {}, &StrokeRow::stroke);
  return join_pieces(rows);
}

void write_strokes(std::ostream& out, const MotionGraph& motion) {
  write_strokes(out, motion, {});
}

void write_strokes(std::ostream& out, const MotionGraph& motion, const Units& units) {
  std::string text = "stroke,frame,x,y,length,patches,width,contrast,ends,junctions";
  detail::end_head(text, units, ",time_s", ",x_um,y_um,length_um");
  for (const Row& row : stroke_rows(motion)) {
    detail::TableLine line(text, units);
    begin_row(line, row);
    line.add(row.ends), line.add(row.junctions);
    end_row(line, row);
  }
  detail::write_table(out, text);
}

std::vector<StrokeLife> stroke_lives(const MotionGraph& motion) {
  const auto rows = stroke_rows(motion);
  std::vector<StrokeLife> lives;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && rows[end].stroke == rows[begin].stroke) ++end;
    lives.push_back(life_of(std::span(rows).subspan(begin, end - begin), motion.sketch.frames.size()));
    begin = end;
  }
  return lives;
}

void write_lives(std::ostream& out, const std::vector<StrokeLife>& lives, const Units& units) {
  std::string text = "stroke,first,last,frames,whole,length,growth,speed";
  detail::end_head(text, units, ",life_s", ",length_um", ",growth_um_s,speed_um_s");
  for (const StrokeLife& life : lives) {
    detail::TableLine line(text, units);
    line.add(life.stroke);
    for (const int value : {life.first, life.last, life.frames(), life.whole ? 1 : 0})
      line.add(static_cast<std::uint32_t>(value));
    for (const double value : {life.length, life.growth, life.speed}) line.add(value);
    if (units.seconds) line.add(units.span(life.first, life.last + 1));
    line.add_length_um(life.length);
    if (units.seconds && units.um)
      for (const double value : {life.growth, life.speed})
        line.add(value * *units.um / units.step(life.first, life.last));
    line.end();
  }
  detail::write_table(out, text);
}

}  // namespace emberfold::graph
