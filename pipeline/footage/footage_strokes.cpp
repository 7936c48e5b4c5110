// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kPlace = 2, kShape = 4, kLevel = 10, kPair = 2, kCount = 3;

[[noreturn]] void refuse_strokes(const std::string& name) {
  throw core::IoError("motion model: " + name + ".npy does not fit the footage");
}

template <class Number>
const std::vector<Number>& column(const core::ModelArchive& archive, const std::string& name,
                                  std::size_t row) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse_strokes(name);
  const auto* const data = std::get_if<std::vector<Number>>(&found->second.data);
  if (data == nullptr || data->size() % row != 0) refuse_strokes(name);
  return *data;
}

template <class Number>
void add_column(core::ModelArchive& archive, const std::string& name, std::size_t row,
                std::vector<Number> data) {
  archive.arrays[name] = {{data.size() / row, row}, false, std::move(data)};
}

std::uint8_t byte(float level) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.F, 255.F)));
}

graph::Patch patch_of(const float* place, const core::Half* shape, const std::uint8_t* levels) {
  graph::Patch patch;
  if (levels[9] >= static_cast<std::uint8_t>(graph::PatchType::anchor)) refuse_strokes("footage_levels");
  patch.type = static_cast<graph::PatchType>(levels[9]);
  patch.position = {double{place[0]}, double{place[1]}};
  patch.theta = double{core::to_float(shape[0])};
  patch.width = double{core::to_float(shape[1])};
  patch.blur = double{core::to_float(shape[2])};
  patch.contrast = double{core::to_float(shape[3])};
  for (std::size_t c = 0; c < 3; ++c) {
    patch.left[c] = levels[c];
    patch.middle[c] = levels[3 + c];
    patch.right[c] = levels[6 + c];
  }
  return patch;
}

/// Returns the links from one frame to a later one, composed of the links between. Competing links, whose
/// both ends have others, are dropped, so that the rest form a star forest.
std::vector<graph::Link> links_between(const graph::MotionGraph& motion, int from, int to) {
  auto links = motion.links[static_cast<std::size_t>(from) + 1];
  for (int t = from + 2; t <= to; ++t) {
    std::set<graph::Link> further;
    for (const auto& link : links)
      for (const auto& next : motion.links[static_cast<std::size_t>(t)])
        if (next.before == link.after) further.insert({link.before, next.after});
    links.assign(further.begin(), further.end());
  }
  if (to == from + 1) return links;
  std::set<std::uint32_t> before, after;
  std::erase_if(links, [&](const graph::Link& link) {
    const bool competes = before.contains(link.before.value) || after.contains(link.after.value);
    before.insert(link.before.value), after.insert(link.after.value);
    return competes;
  });
  return links;
}

}  // namespace

graph::MotionGraph strokes_of_frames(const graph::MotionGraph& motion, std::span<const int> kept) {
  graph::MotionGraph strokes;
  strokes.sketch.width = motion.sketch.width, strokes.sketch.height = motion.sketch.height;
  strokes.sketch.fps = motion.sketch.fps;
  const auto at = [&](int t) -> const graph::AttributeGraph& {
    return motion.sketch.frames[static_cast<std::size_t>(t)];
  };
  for (std::size_t i = 0; i < kept.size(); ++i) {
    strokes.sketch.append(at(kept[i]));
    strokes.links.emplace_back();
    if (i == 0) continue;
    const auto &before = strokes.sketch.frames[i - 1], &after = strokes.sketch.frames[i];
    for (const auto& link : links_between(motion, kept[i - 1], kept[i]))
      strokes.links[i].push_back({before.vertices()[at(kept[i - 1]).index_of(link.before)].id,
                                  after.vertices()[at(kept[i]).index_of(link.after)].id});
  }
  return graph::identify(std::move(strokes));
}

void add_footage_strokes(core::ModelArchive& archive, const graph::MotionGraph& strokes) {
  if (strokes.sketch.frames.empty()) return;
  std::vector<float> places;
  std::vector<core::Half> shapes;
  std::vector<std::uint8_t> levels;
  std::vector<std::int32_t> joins, links, counts;
  const auto pair = [](std::vector<std::int32_t>& to, std::size_t a, std::size_t b) {
    to.insert(to.end(), {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
  };
  for (std::size_t t = 0; t < strokes.sketch.frames.size(); ++t) {
    const auto& graph = strokes.sketch.frames[t];
    for (const auto& vertex : graph.vertices()) {
      const auto& p = vertex.patch;
      places.insert(places.end(), {static_cast<float>(p.position.x), static_cast<float>(p.position.y)});
      for (const double number : {p.theta, p.width, p.blur, p.contrast})
        shapes.push_back(core::to_half(static_cast<float>(number)));
      for (const auto* side : {&p.left, &p.middle, &p.right})
        for (const float level : *side) levels.push_back(byte(level));
      levels.push_back(static_cast<std::uint8_t>(p.type));
    }
    for (const auto& edge : graph.edges()) pair(joins, graph.index_of(edge.a), graph.index_of(edge.b));
    for (const auto& link : strokes.links[t])
      pair(links, strokes.sketch.frames[t - 1].index_of(link.before), graph.index_of(link.after));
    for (const std::size_t count : {graph.size(), graph.edges().size(), strokes.links[t].size()})
      counts.push_back(static_cast<std::int32_t>(count));
  }
  add_column(archive, "footage_places", kPlace, std::move(places));
  add_column(archive, "footage_shapes", kShape, std::move(shapes));
  add_column(archive, "footage_levels", kLevel, std::move(levels));
  add_column(archive, "footage_joins", kPair, std::move(joins));
  add_column(archive, "footage_links", kPair, std::move(links));
  add_column(archive, "footage_counts", kCount, std::move(counts));
}

graph::MotionGraph read_footage_strokes(const core::ModelArchive& archive, std::size_t frames) {
  graph::MotionGraph strokes;
  if (!archive.arrays.contains("footage_counts")) return strokes;
  const auto& counts = column<std::int32_t>(archive, "footage_counts", kCount);
  const auto& places = column<float>(archive, "footage_places", kPlace);
  const auto& shapes = column<core::Half>(archive, "footage_shapes", kShape);
  const auto& levels = column<std::uint8_t>(archive, "footage_levels", kLevel);
  const auto& joins = column<std::int32_t>(archive, "footage_joins", kPair);
  const auto& links = column<std::int32_t>(archive, "footage_links", kPair);
  if (counts.size() != kCount * frames) refuse_strokes("footage_counts");
  std::size_t patch = 0, join = 0, link = 0;
  const auto take = [&](const std::vector<std::int32_t>& list, std::size_t& at, const std::string& name,
                        std::size_t most_a, std::size_t most_b) {
    if (kPair * (at + 1) > list.size()) refuse_strokes(name);
    const auto a = static_cast<std::uint32_t>(list[kPair * at]),
               b = static_cast<std::uint32_t>(list[kPair * at + 1]);
    ++at;
    if (a >= most_a || b >= most_b) refuse_strokes(name);
    return std::pair{a, b};
  };
  std::uint32_t id = 0;
  try {
    for (std::size_t t = 0; t < frames; ++t) {
      for (std::size_t k = 0; k < kCount; ++k)
        if (counts[kCount * t + k] < 0) refuse_strokes("footage_counts");
      const auto size = static_cast<std::size_t>(counts[kCount * t]);
      if (patch + size > std::min({places.size() / kPlace, shapes.size() / kShape, levels.size() / kLevel}))
        refuse_strokes("footage_places");
      std::vector<graph::Vertex> vertices;
      const std::uint32_t first = id;
      for (std::size_t i = 0; i < size; ++i, ++patch)
        vertices.push_back(
            {{id++},
             {},
             patch_of(&places[kPlace * patch], &shapes[kShape * patch], &levels[kLevel * patch])});
      std::vector<graph::Edge> edges;
      for (auto left = counts[kCount * t + 1]; left > 0; --left) {
        const auto [a, b] = take(joins, join, "footage_joins", size, size);
        edges.push_back({{first + a}, {first + b}});
      }
      strokes.links.emplace_back();
      const std::size_t before = t == 0 ? 0 : strokes.sketch.frames.back().size();
      for (auto left = counts[kCount * t + 2]; left > 0; --left) {
        const auto [a, b] = take(links, link, "footage_links", before, size);
        strokes.links.back().push_back({{first - static_cast<std::uint32_t>(before) + a}, {first + b}});
      }
      strokes.sketch.frames.emplace_back(std::move(vertices), std::move(edges));
    }
    return graph::identify(std::move(strokes));
  } catch (const core::InputError& error) {
    throw core::IoError(std::string("motion model: the strokes of the footage: ") + error.what());
  }
}

}  // namespace emberfold::pipeline
