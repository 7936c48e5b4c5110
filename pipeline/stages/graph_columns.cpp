// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/graph_columns.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include "core/error.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kNumbers = 9, kLevels = 9, kIds = 3;

[[noreturn]] void refuse(const std::string& name) {
  throw core::IoError("the column " + name + " does not fit the others");
}

/// Returns an array's values. `row`: the length of a row, by which their number must be divisible.
template <class Value>
const std::vector<Value>& values(const io::Columns& columns, const std::string& name, std::size_t row) {
  const auto found = columns.arrays.find(name);
  if (found == columns.arrays.end()) refuse(name);
  const auto* const data = std::get_if<std::vector<Value>>(&found->second.data);
  if (data == nullptr || found->second.fortran_order || data->size() % row != 0) refuse(name);
  return *data;
}

template <class Value>
void add(io::Columns& columns, const std::string& name, const std::vector<std::size_t>& row,
         std::vector<Value> data) {
  std::size_t size = 1;
  for (const std::size_t length : row) size *= length;
  std::vector<std::size_t> shape(row.size() + 1, size == 0 ? 0 : data.size() / size);
  std::ranges::copy(row, shape.begin() + 1);
  columns.arrays[name] = {std::move(shape), false, std::move(data)};
}

/// Returns the offsets at which frames begin, checked to ascend from 0 to `count`.
std::vector<std::size_t> begins(const std::vector<std::int64_t>& list, std::size_t row, std::size_t column,
                                std::size_t count) {
  std::vector<std::size_t> found;
  for (std::size_t i = column; i < list.size(); i += row) {
    const std::int64_t least = found.empty() ? 0 : static_cast<std::int64_t>(found.back());
    if (list[i] < least || static_cast<std::size_t>(list[i]) > count || (found.empty() && list[i] != 0))
      refuse("frames");
    found.push_back(static_cast<std::size_t>(list[i]));
  }
  if (found.empty() || found.back() != count) refuse("frames");
  return found;
}

template <class Value>
cv::Mat picture(const std::vector<Value>& data, std::size_t at, int rows, int cols, int type) {
  cv::Mat made(rows, cols, type);
  std::copy_n(data.data() + at, made.total() * static_cast<std::size_t>(made.channels()), made.ptr<Value>());
  return made;
}

template <class Value>
void append(std::vector<Value>& data, const cv::Mat& picture) {
  const cv::Mat whole = picture.isContinuous() ? picture : picture.clone();
  data.insert(data.end(), whole.ptr<Value>(),
              whole.ptr<Value>() + whole.total() * static_cast<std::size_t>(whole.channels()));
}

graph::Patch patch_of(const double* numbers, const float* levels, std::uint8_t type) {
  if (type > static_cast<std::uint8_t>(graph::PatchType::anchor)) refuse("types");
  graph::Patch patch;
  patch.type = static_cast<graph::PatchType>(type);
  patch.position = {numbers[0], numbers[1]};
  patch.theta = numbers[2], patch.width = numbers[3], patch.blur = numbers[4], patch.contrast = numbers[5];
  patch.cost = numbers[6], patch.gain = numbers[7], patch.evidence = numbers[8];
  std::copy_n(levels, 3, patch.left.begin());
  std::copy_n(levels + 3, 3, patch.middle.begin());
  std::copy_n(levels + 6, 3, patch.right.begin());
  return patch;
}

}  // namespace

void add_graphs(io::Columns& columns, std::span<const graph::AttributeGraph> frames) {
  std::vector<std::int64_t> begin{0, 0}, ids;
  std::vector<double> numbers;
  std::vector<float> levels;
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> edges;
  for (const auto& graph : frames) {
    for (const auto& [id, stroke, p, curve] : graph.vertices()) {
      numbers.insert(numbers.end(), {p.position.x, p.position.y, p.theta, p.width, p.blur, p.contrast, p.cost,
                                     p.gain, p.evidence});
      for (const auto* level : {&p.left, &p.middle, &p.right})
        levels.insert(levels.end(), level->begin(), level->end());
      types.push_back(static_cast<std::uint8_t>(p.type));
      ids.insert(ids.end(), {id.value, stroke.value, curve.value});
    }
    for (const auto& edge : graph.edges())
      for (const auto end : {edge.a, edge.b}) edges.push_back(static_cast<std::int32_t>(graph.index_of(end)));
    begin.insert(begin.end(),
                 {static_cast<std::int64_t>(types.size()), static_cast<std::int64_t>(edges.size() / 2)});
  }
  add(columns, "frames", {2}, std::move(begin));
  add(columns, "numbers", {kNumbers}, std::move(numbers));
  add(columns, "levels", {kLevels}, std::move(levels));
  add(columns, "types", {}, std::move(types));
  add(columns, "ids", {kIds}, std::move(ids));
  add(columns, "edges", {2}, std::move(edges));
}

std::vector<graph::AttributeGraph> read_graphs(const io::Columns& columns, const graph::GraphMemory& memory) {
  const auto& types = values<std::uint8_t>(columns, "types", 1);
  const auto& numbers = values<double>(columns, "numbers", kNumbers);
  const auto& levels = values<float>(columns, "levels", kLevels);
  const auto& ids = values<std::int64_t>(columns, "ids", kIds);
  const auto& edges = values<std::int32_t>(columns, "edges", 2);
  const auto& frames = values<std::int64_t>(columns, "frames", 2);
  const std::size_t count = types.size();
  if (numbers.size() != kNumbers * count) refuse("numbers");
  if (levels.size() != kLevels * count) refuse("levels");
  if (ids.size() != kIds * count) refuse("ids");
  const auto patches = begins(frames, 2, 0, count), joins = begins(frames, 2, 1, edges.size() / 2);
  std::vector<graph::AttributeGraph> graphs;
  for (std::size_t t = 0; t + 1 < patches.size(); ++t) {
    const std::size_t from = patches[t], size = patches[t + 1] - from;
    std::vector<graph::Vertex> vertices;
    for (std::size_t i = from; i < from + size; ++i) {
      for (std::size_t k = 0; k < kIds; ++k)
        if (ids[kIds * i + k] < 0 || ids[kIds * i + k] > UINT32_MAX) refuse("ids");
      const auto id = [&](std::size_t k) { return static_cast<std::uint32_t>(ids[kIds * i + k]); };
      vertices.push_back(
          {{id(0)}, {id(1)}, patch_of(&numbers[kNumbers * i], &levels[kLevels * i], types[i]), {id(2)}});
    }
    std::vector<graph::Edge> joined;
    for (std::size_t e = joins[t]; e < joins[t + 1]; ++e) {
      const auto end = [&](std::size_t k) {
        const std::int32_t index = edges[2 * e + k];
        if (index < 0 || static_cast<std::size_t>(index) >= size) refuse("edges");
        return vertices[static_cast<std::size_t>(index)].id;
      };
      joined.push_back({end(0), end(1)});
    }
    try {
      graphs.emplace_back(std::move(vertices), std::move(joined), memory);
    } catch (const core::InputError& error) {
      throw core::IoError(error.what());
    }
  }
  return graphs;
}

void add_grounds(io::Columns& columns, std::span<const sketch::FrameBackground> grounds) {
  if (grounds.empty()) return;
  std::vector<float> cells;
  std::vector<std::uint8_t> open, seen;
  for (const auto& ground : grounds) {
    append(cells, ground.levels);
    append(open, ground.uncovered);
    append(seen, ground.level_range.low);
    append(seen, ground.level_range.high);
  }
  const auto size = [](int n) { return static_cast<std::size_t>(n); };
  const cv::Mat &one = grounds[0].levels, &range = grounds[0].level_range.low;
  add(columns, "cells", {size(one.rows), size(one.cols), size(one.channels())}, std::move(cells));
  add(columns, "open", {size(one.rows), size(one.cols)}, std::move(open));
  add(columns, "seen", {2, size(range.rows), size(range.cols), size(range.channels())}, std::move(seen));
}

std::vector<sketch::FrameBackground> read_grounds(const io::Columns& columns) {
  const auto& cells = values<float>(columns, "cells", 1);
  const auto& open = values<std::uint8_t>(columns, "open", 1);
  const auto& seen = values<std::uint8_t>(columns, "seen", 1);
  const auto &shape = columns.arrays.at("cells").shape, &range = columns.arrays.at("seen").shape;
  if (shape.size() != 4 || range.size() != 5 || range[0] != shape[0] || range[1] != 2 ||
      (shape[3] != 1 && shape[3] != 3) || range[4] != shape[3])
    refuse("cells");
  const std::size_t area = shape[1] * shape[2], channels = shape[3], around = range[2] * range[3] * channels;
  if (open.size() != shape[0] * area) refuse("open");
  const int depth = static_cast<int>(channels);
  const int rows = static_cast<int>(shape[1]), cols = static_cast<int>(shape[2]);
  const int down = static_cast<int>(range[2]), across = static_cast<int>(range[3]);
  std::vector<sketch::FrameBackground> grounds;
  for (std::size_t t = 0; t < shape[0]; ++t)
    grounds.push_back({picture(cells, t * area * channels, rows, cols, CV_32FC(depth)),
                       picture(open, t * area, rows, cols, CV_8U),
                       {picture(seen, 2 * t * around, down, across, CV_8UC(depth)),
                        picture(seen, (2 * t + 1) * around, down, across, CV_8UC(depth))}});
  return grounds;
}

void add_links(io::Columns& columns, std::span<const std::vector<graph::Link>> links_of) {
  std::vector<std::int64_t> begin{0}, links;
  for (const auto& gap : links_of) {
    for (const auto& link : gap) links.insert(links.end(), {link.before.value, link.after.value});
    begin.push_back(static_cast<std::int64_t>(links.size() / 2));
  }
  add(columns, "link_frames", {}, std::move(begin));
  add(columns, "links", {2}, std::move(links));
}

std::vector<std::vector<graph::Link>> read_links(const io::Columns& columns) {
  const auto& links = values<std::int64_t>(columns, "links", 2);
  const auto begin = begins(values<std::int64_t>(columns, "link_frames", 1), 1, 0, links.size() / 2);
  std::vector<std::vector<graph::Link>> gaps(begin.size() - 1);
  for (std::size_t t = 0; t + 1 < begin.size(); ++t)
    for (std::size_t i = begin[t]; i < begin[t + 1]; ++i) {
      const auto end = [&](std::size_t k) {
        if (links[2 * i + k] < 0 || links[2 * i + k] > UINT32_MAX) refuse("links");
        return graph::VertexId{static_cast<std::uint32_t>(links[2 * i + k])};
      };
      gaps[t].push_back({end(0), end(1)});
    }
  return gaps;
}

namespace {

/// Moves the offsets at which frames begin from a block of columns to `begin`, counted on from the frames
/// before. `row`: numbers per frame.
void move_begins(io::Columns& columns, const std::string& name, std::size_t row,
                 std::vector<std::int64_t>& begin) {
  const auto found = columns.arrays.extract(name);
  const auto& more = std::get<std::vector<std::int64_t>>(found.mapped().data);
  if (begin.empty()) begin.assign(row, 0);
  const std::size_t before = begin.size() - row;
  for (std::size_t i = row; i < more.size(); ++i) begin.push_back(begin[before + i % row] + more[i]);
}

}  // namespace

void write_graphs(io::ColumnWriter& writer, const graph::SketchSequence& sketch,
                  std::span<const sketch::FrameBackground> grounds,
                  std::span<const std::vector<graph::Link>> links) {
  constexpr std::size_t kTogether = 32;  // frames
  const std::span frames(sketch.frames);
  std::vector<std::int64_t> begin, begin_links;
  std::size_t first = 0;
  do {
    const std::size_t count = std::min(kTogether, frames.size() - first);
    io::Columns block;
    add_graphs(block, frames.subspan(first, count));
    move_begins(block, "frames", 2, begin);
    if (!grounds.empty()) add_grounds(block, grounds.subspan(first, count));
    if (!links.empty()) {
      add_links(block, links.subspan(first, count));
      move_begins(block, "link_frames", 1, begin_links);
    }
    writer.append(block.arrays);
    first += count;
  } while (first < frames.size());
  io::Columns whole;
  add(whole, "frames", {2}, std::move(begin));
  if (!links.empty()) add(whole, "link_frames", {}, std::move(begin_links));
  writer.append(whole.arrays);
}

}  // namespace emberfold::pipeline
