// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage_strokes.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "tests/pipeline/carried/carried_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("footage strokes: graphs, links and strokes come back through the archive") {
  const auto seen = carried_scene(20).strokes;
  core::ModelArchive archive;
  pipeline::add_footage_strokes(archive, seen);
  auto read = pipeline::read_footage_strokes(archive, 20);
  REQUIRE(read.sketch.frames.size() == 20);
  CHECK(read.links == seen.links);
  for (std::size_t t = 0; t < 20; ++t) {
    const auto &one = seen.sketch.frames[t], &other = read.sketch.frames[t];
    REQUIRE(one.size() == other.size());
    CHECK(std::ranges::equal(one.edges(), other.edges()));
    for (std::size_t v = 0; v < one.size(); ++v) {
      CHECK(graph::distance(one.patch(v).position, other.patch(v).position) < 1e-4);
      CHECK(one.patch(v).type == other.patch(v).type);
      CHECK(std::abs(one.patch(v).contrast - other.patch(v).contrast) < 0.1);
      CHECK(one.patch(v).middle == other.patch(v).middle);
      CHECK(one.vertices()[v].subgraph == other.vertices()[v].subgraph);
    }
  }
  core::ModelArchive again;
  pipeline::add_footage_strokes(again, read);
  CHECK(again.arrays == archive.arrays);
  CHECK(pipeline::read_footage_strokes({}, 20).sketch.frames.empty());
}

TEST_CASE("footage strokes: links go on over frames that are left out") {
  const auto seen = carried_scene(12).strokes;
  constexpr std::array kKept{0, 1, 4, 5, 11};
  const auto kept = pipeline::strokes_of_frames(seen, kKept);
  REQUIRE(kept.sketch.frames.size() == 5);
  for (std::size_t i = 1; i < kKept.size(); ++i) {
    const auto &before = kept.sketch.frames[i - 1], &now = kept.sketch.frames[i];
    CHECK(before.size() == seen.sketch.frames[static_cast<std::size_t>(kKept[i - 1])].size());
    std::size_t stay = 0;
    for (const auto& link : kept.links[i]) {
      const auto from = before.patch(before.index_of(link.before)).position,
                 to = now.patch(now.index_of(link.after)).position;
      CHECK(from.x == to.x);
      CHECK_THAT(to.y - from.y, Catch::Matchers::WithinAbs(0.25 * (kKept[i] - kKept[i - 1]), 1e-9));
    }
    // A line stays in both frames where its patches' columns and drift agree.
    for (const auto& vertex : before.vertices())
      for (const auto& later : now.vertices())
        stay += vertex.patch.position.x == later.patch.position.x &&
                std::abs(later.patch.position.y - vertex.patch.position.y -
                         0.25 * (kKept[i] - kKept[i - 1])) < 1e-9;
    CHECK(kept.links[i].size() == stay);
  }
}

TEST_CASE("footage strokes: arrays that do not fit are refused by name") {
  const auto seen = carried_scene(6).strokes;
  core::ModelArchive good;
  pipeline::add_footage_strokes(good, seen);
  const auto refused = [&](const std::string& name, const auto& change) {
    auto archive = good;
    change(archive);
    const auto message = message_of<core::IoError>([&] { (void)pipeline::read_footage_strokes(archive, 6); });
    INFO(name << ": " << message);
    CHECK(contains(message, name));
  };
  const auto ints = [](core::ModelArchive& archive, const std::string& name) -> std::vector<std::int32_t>& {
    return std::get<std::vector<std::int32_t>>(archive.arrays.at(name).data);
  };
  for (const std::string name :
       {"footage_places", "footage_shapes", "footage_levels", "footage_joins", "footage_links"})
    refused(name, [&](auto& archive) { archive.arrays.erase(name); });
  refused("footage_counts", [&](auto& archive) { ints(archive, "footage_counts").resize(15); });
  refused("footage_counts", [&](auto& archive) { ints(archive, "footage_counts")[0] = -1; });
  refused("footage_places", [&](auto& archive) { ints(archive, "footage_counts")[0] += 1000000; });
  refused("footage_joins", [&](auto& archive) { ints(archive, "footage_joins")[0] = 1000; });
  refused("footage_links", [&](auto& archive) { ints(archive, "footage_links")[1] = -1; });
  refused("footage_levels", [&](auto& archive) {
    std::get<std::vector<std::uint8_t>>(archive.arrays.at("footage_levels").data)[9] = 200;
  });
  refused("the strokes of the footage", [&](auto& archive) {
    std::get<std::vector<float>>(archive.arrays.at("footage_places").data)[0] = NAN;
  });
}
