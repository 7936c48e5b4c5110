// SPDX-License-Identifier: Apache-2.0
#include "graph/io/motion_io.hpp"

#include <cmath>
#include <limits>
#include <ostream>
#include <string>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/patch_range.hpp"
#include "graph/io/table_text.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

namespace {

using core::append_number;

template <class Value>
void append_field(std::string& text, std::string_view name, Value value) {
  text += ",\"";
  text += name;
  text += "\":";
  core::append_number(text, value);
}

void append_level(std::string& text, std::string_view name, const Level& level) {
  if (level[0] == level[1] && level[1] == level[2] && std::signbit(level[0]) == std::signbit(level[1]) &&
      std::signbit(level[1]) == std::signbit(level[2])) {
    append_field(text, name, level[0]);
    return;
  }
  text += ",\"";
  text += name;
  text += "\":[";
  for (std::size_t c = 0; c < level.size(); ++c) {
    if (c > 0) text += ',';
    core::append_number(text, level[c]);
  }
  text += ']';
}

void append_anchor(std::string& text, const Vertex& vertex) {
  text += "{\"id\":";
  core::append_number(text, vertex.id.value);
  text += ",\"type\":\"anchor\"";
  append_field(text, "x", vertex.patch.position.x);
  append_field(text, "y", vertex.patch.position.y);
  append_level(text, "middle", vertex.patch.middle);
  text += '}';
}

void append_vertex(std::string& text, const Vertex& vertex, const SketchSequence& sketch) {
  const Patch& patch = vertex.patch;
  if (const auto wrong = detail::describe_range_error(patch, sketch.width, sketch.height); !wrong.empty()) {
    throw core::InputError("writing a sketch: vertex " + std::to_string(vertex.id.value) + ": " + wrong);
  }
  if (is_anchor(patch)) return append_anchor(text, vertex);
  text += "{\"id\":";
  core::append_number(text, vertex.id.value);
  append_field(text, "subgraph", vertex.subgraph.value);
  if (vertex.curve.value != 0) append_field(text, "curve", vertex.curve.value);
  text += ",\"type\":\"";
  text += name(patch.type);
  text += '"';
  append_field(text, "x", patch.position.x);
  append_field(text, "y", patch.position.y);
  append_field(text, "theta", patch.theta);
  append_field(text, "width", patch.width);
  append_field(text, "blur", patch.blur);
  append_field(text, "contrast", patch.contrast);
  append_level(text, "left", patch.left);
  append_level(text, "middle", patch.middle);
  append_level(text, "right", patch.right);
  if (patch.cost != 0) append_field(text, "cost", patch.cost);
  if (patch.gain != 0) append_field(text, "gain", patch.gain);
  if (patch.evidence != 0) append_field(text, "evidence", patch.evidence);
  text += '}';
}

void append_pair(std::string& text, VertexId a, VertexId b) {
  if (text.back() != '[') text += ',';
  text += '[';
  core::append_number(text, a.value);
  text += ',';
  core::append_number(text, b.value);
  text += ']';
}

/// Returns the first line of a sketch or, with `links`, a motion graph of so many frames.
std::string header_line(const SketchSequence& sketch, std::size_t frames, bool links) {
  const auto in_range = [](int value) { return value >= 1 && value <= 65536; };
  if (!in_range(sketch.width) || !in_range(sketch.height)) {
    throw core::InputError("writing a sketch: its size is " + std::to_string(sketch.width) + " x " +
                           std::to_string(sketch.height) + ", allowed is 1 to 65536");
  }
  if (!(sketch.fps > 0 && sketch.fps <= 1e6)) {
    throw core::InputError("writing a sketch: fps is " + std::to_string(sketch.fps) +
                           ", allowed is above 0, up to 1e6");
  }
  std::string text = "{\"format\":\"";
  text += links ? "emberfold.motion" : "emberfold.sketch";
  text += links ? "\",\"version\":2" : "\",\"version\":1";
  append_field(text, "width", static_cast<std::uint32_t>(sketch.width));
  append_field(text, "height", static_cast<std::uint32_t>(sketch.height));
  append_field(text, "fps", sketch.fps);
  append_field(text, "frames", static_cast<std::uint32_t>(frames));
  return text + "}\n";
}

/// Returns the line of the sequence's frame `frame`, number `t` of the file.
std::string frame_line(const SketchSequence& sketch, std::size_t frame, std::size_t t,
                       const MotionGraph* motion) {
  std::string text = "{\"frame\":";
  core::append_number(text, static_cast<std::uint32_t>(t));
  text += ",\"vertices\":[";
  for (const Vertex& vertex : sketch.frames[frame].vertices()) {
    if (text.back() != '[') text += ',';
    append_vertex(text, vertex, sketch);
  }
  text += "],\"edges\":[";
  for (const Edge& edge : sketch.frames[frame].edges()) append_pair(text, edge.a, edge.b);
  if (motion != nullptr) {
    text += "],\"links\":[";
    for (const Link& link : all_links(*motion, t)) append_pair(text, link.before, link.after);
    if (!motion->skipped.empty() && !motion->skipped[t].empty()) {
      text += "],\"skipped\":[";
      for (const Link& link : motion->skipped[t]) append_pair(text, link.before, link.after);
    }
  }
  return text + "]}\n";
}

void put(std::ostream& out, const std::string& text) {
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void finish_stream(std::ostream& out) {
  if (!out.flush()) throw core::IoError("a sketch could not be written: the stream failed");
}

}  // namespace

void write_sketch(std::ostream& out, const SketchSequence& sketch) {
  put(out, header_line(sketch, sketch.frames.size(), false));
  for (std::size_t t = 0; t < sketch.frames.size(); ++t) put(out, frame_line(sketch, t, t, nullptr));
  finish_stream(out);
}

void write_motion(std::ostream& out, const MotionGraph& motion) {
  validate(motion);
  const SketchSequence& sketch = motion.sketch;
  put(out, header_line(sketch, sketch.frames.size(), true));
  for (std::size_t t = 0; t < sketch.frames.size(); ++t) put(out, frame_line(sketch, t, t, &motion));
  finish_stream(out);
}

SketchWriter::SketchWriter(std::ostream& out, int width, int height, double fps)
    : out_(out), last_{width, height, fps, {}} {
  // As long as the header of any number of frames, whose place it keeps.
  std::string text = header_line(last_, std::numeric_limits<std::int32_t>::max(), false);
  put(out_, std::string(text.size() - 1, ' ') + "\n");
}

void SketchWriter::add(const AttributeGraph& graph) {
  last_.append(graph);
  const std::size_t frame = last_.frames.size() - 1;
  put(out_, frame_line(last_, frame, frames_++, nullptr));
  auto& frames = last_.frames;
  if (frames.size() > 1) frames.erase(graph.empty() ? frames.end() - 1 : frames.begin());
}

void SketchWriter::finish() {
  finish_stream(out_);
  const std::string text = header_line(last_, frames_, false);
  out_.seekp(0);
  out_.write(text.data(), static_cast<std::streamsize>(text.size() - 1));
  out_.seekp(0, std::ios::end);
  finish_stream(out_);
}

void write_trajectories(std::ostream& out, const MotionGraph& motion) {
  write_trajectories(out, motion, {});
}

void write_trajectories(std::ostream& out, const MotionGraph& motion, const Units& units) {
  std::string text = "trajectory,frame,vertex,stroke,x,y,theta,width,blur,contrast";
  detail::end_head(text, units, "", "");
  std::uint32_t number = 0;
  for (const Trajectory& course : trajectories(motion)) {
    auto t = static_cast<std::size_t>(course.first_frame);
    for (const VertexId id : course.vertices) {
      const AttributeGraph& graph = motion.sketch.frames[t];
      const Vertex& vertex = graph.vertices()[graph.index_of(id)];
      detail::TableLine line(text, units);
      line.add(number), line.add(static_cast<std::uint32_t>(t));
      line.add(id.value), line.add(vertex.subgraph.value);
      line.add_place(vertex.patch.position);
      line.add(vertex.patch.theta), line.add(vertex.patch.width);
      line.add(vertex.patch.blur), line.add(vertex.patch.contrast);
      line.end();
      ++t;
    }
    ++number;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("trajectories could not be written: the stream failed");
}

}  // namespace emberfold::graph
