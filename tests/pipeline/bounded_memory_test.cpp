// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "core/context.hpp"
#include "core/io/mapped_memory.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/stages/analysis_stages.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_motion.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Bytes on the heap that are in use; 0 where that is not known.
std::size_t heap_bytes() {
#ifdef __GLIBC__
  const auto info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

/// The most that was in use at any report of progress, and how many patches the clip has.
struct Most {
  std::map<std::string, std::size_t> heap;  // stage
  std::size_t mapped = 0, patches = 0;
};

Most analyze_clip(int frames) {
  constexpr int kWidth = 120, kHeight = 90, kPeriod = 12;
  // The same pictures again and again, to and fro: a long clip is as full as a short one.
  const auto strokes = made_strokes(8, kWidth, kHeight, kPeriod);
  core::Clip clip;
  clip.info.width = kWidth, clip.info.height = kHeight, clip.info.channels = 3, clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) {
    const int phase = t % (2 * kPeriod - 2);
    clip.frames.push_back(made_picture(strokes, kWidth, kHeight, std::min(phase, 2 * kPeriod - 2 - phase)));
  }
  core::ClipSource source(clip);
  const TempFolder temp;
  const auto memory = std::make_shared<io::MappedMemory>(temp.path());
  Most most;
  const std::size_t before = heap_bytes();
  const auto sample = [&](std::string_view stage, double) {
    auto& heap = most.heap[std::string(stage)];
    heap = std::max(heap, heap_bytes() - std::min(before, heap_bytes()));
    most.mapped = std::max(most.mapped, memory->used_bytes());
  };
  const core::Context context = core::Context({}, sample).with_memory(memory);
  const pipeline::AnalysisStages stages(temp / "run", {"sketch", "motion", "model"});
  const auto found = pipeline::analyze(source, {}, context, &stages);
  for (const auto& graph : found.motion.sketch.frames) most.patches += graph.size();
  return most;
}

}  // namespace

TEST_CASE("Memory grows with the clip by no more than its graphs need", "[slow]") {
  const Most shorter = analyze_clip(40), longer = analyze_clip(200);
  REQUIRE(longer.patches > 3 * shorter.patches);
  const auto more = static_cast<double>(longer.patches - shorter.patches);
  // A patch takes some 170 bytes in a graph. There are the sketch, what was filled in, and what was matched
  // of it, twice.
  const double mapped = static_cast<double>(longer.mapped - shorter.mapped) / more;
  INFO("mapped: " << mapped << " bytes a patch");
  CHECK(mapped < 1500);
  for (const auto& [stage, bytes] : longer.heap) {
    const auto at_first = shorter.heap.count(stage) > 0 ? shorter.heap.at(stage) : 0;
    const double heap = (static_cast<double>(bytes) - static_cast<double>(at_first)) / more;
    INFO(stage << ": " << heap << " bytes a patch");
    CHECK(heap < (stage == "match" ? 100 : 250));  // no copy of the graphs; tracks and what is learned
  }
}
