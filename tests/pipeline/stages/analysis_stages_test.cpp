// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/analysis_stages.hpp"

#include <algorithm>
#include <fstream>
#include <stop_token>
#include <string>

#include "core/context.hpp"
#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "pipeline/stages/graph_columns.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_motion.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

core::Clip moving_strokes(int frames) {
  const int width = 120, height = 90;
  const auto strokes = made_strokes(8, width, height, frames);
  core::Clip clip;
  clip.info.width = width, clip.info.height = height, clip.info.channels = 3, clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) clip.frames.push_back(made_picture(strokes, width, height, t));
  return clip;
}

/// Counts the frames that are read, and asks to stop after some of them.
class CountingSource final : public core::FrameSource {
 public:
  explicit CountingSource(const core::Clip& clip, std::stop_source* stop = nullptr, int stop_after = 0)
      : source_(clip), stop_(stop), stop_after_(stop_after) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override {
    if (++read == stop_after_ && stop_ != nullptr) stop_->request_stop();
    return source_.next();
  }
  void rewind() override { source_.rewind(); }
  int read = 0;

 private:
  core::ClipSource source_;
  std::stop_source* stop_;
  int stop_after_;
};

bool same(const pipeline::SketchedClip& a, const pipeline::SketchedClip& b) {
  if (a.sketch != b.sketch || a.grounds.size() != b.grounds.size()) return false;
  for (std::size_t t = 0; t < a.grounds.size(); ++t) {
    const auto &x = a.grounds[t], &y = b.grounds[t];
    if (!same_pixels(x.levels, y.levels) || !same_pixels(x.uncovered, y.uncovered) ||
        !same_pixels(x.level_range.low, y.level_range.low) ||
        !same_pixels(x.level_range.high, y.level_range.high))
      return false;
  }
  return true;
}

pipeline::AnalyzeOptions quick_options() {
  pipeline::AnalyzeOptions options;
  options.bottom_up = true;
  return options;
}

}  // namespace

TEST_CASE("graphs, backgrounds and links that are kept as columns are read back in every bit") {
  const auto clip = moving_strokes(6);
  core::ClipSource source(clip);
  const auto made = pipeline::sketch_clip(source, {}, {});
  const auto motion = graph::match(made.sketch, {});
  io::Columns columns{"key", "text", {}};
  pipeline::add_graphs(columns, motion.sketch.frames);
  pipeline::add_links(columns, motion.links);
  pipeline::add_grounds(columns, made.grounds);
  const TempFolder temp;
  io::write_columns(temp / "stage", columns);
  CHECK_FALSE(io::read_columns(temp / "stage", "another key"));
  const auto read = io::read_columns(temp / "stage", "key");
  REQUIRE(read);
  CHECK(read->text == "text");
  CHECK(pipeline::read_graphs(*read) == motion.sketch.frames);
  CHECK(pipeline::read_links(*read) == motion.links);
  CHECK(same({made.sketch, pipeline::read_grounds(*read)}, made));
}

TEST_CASE("graphs that are written some frames at a time are the same columns") {
  const auto clip = moving_strokes(70);
  core::ClipSource source(clip);
  const auto made = pipeline::sketch_clip(source, {}, {});
  const auto motion = graph::match(made.sketch, {});
  io::Columns columns{"key", {}, {}};
  pipeline::add_graphs(columns, motion.sketch.frames);
  pipeline::add_links(columns, motion.links);
  pipeline::add_grounds(columns, made.grounds);
  const TempFolder temp;
  io::ColumnWriter writer(temp / "stage");
  pipeline::write_graphs(writer, motion.sketch, made.grounds, motion.links);
  writer.finish("key", {});
  const auto read = io::read_columns(temp / "stage", "key");
  REQUIRE(read);
  CHECK(read->arrays == columns.arrays);
}

TEST_CASE("columns that are cut off or do not fit each other are found out") {
  const auto clip = moving_strokes(4);
  core::ClipSource source(clip);
  const auto made = pipeline::sketch_clip(source, {}, {});
  io::Columns columns{"key", {}, {}};
  pipeline::add_graphs(columns, made.sketch.frames);
  for (const char* name : {"frames", "numbers", "levels", "types", "ids", "edges"}) {
    auto without = columns;
    without.arrays.erase(name);
    INFO(name);
    CHECK_THROWS_AS(pipeline::read_graphs(without), core::IoError);
  }
  auto astray = columns;
  std::get<std::vector<std::int32_t>>(astray.arrays["edges"].data).front() = 1'000'000;
  CHECK_THROWS_AS(pipeline::read_graphs(astray), core::IoError);
  const TempFolder temp;
  io::write_columns(temp / "stage", columns);
  fs::resize_file(temp / "stage/numbers.npy", fs::file_size(temp / "stage/numbers.npy") - 8);
  CHECK_FALSE(io::read_columns(temp / "stage", "key"));
  fs::remove(temp / "stage/numbers.npy");
  CHECK_FALSE(io::read_columns(temp / "stage", "key"));
}

TEST_CASE("a sketch that was stopped goes on where it was, and is the same") {
  const auto clip = moving_strokes(44);
  core::ClipSource plain(clip);
  const auto whole = pipeline::sketch_clip(plain, {}, {});
  const TempFolder temp;
  const pipeline::AnalysisStages stages(temp / "run", {"sketch", "motion", "model"});
  std::stop_source stop;
  CountingSource stopped(clip, &stop, 40);
  CHECK_THROWS_AS(stages.sketch(stopped, {}, core::Context(stop.get_token())), core::Cancelled);
  REQUIRE(fs::exists(temp / "run/stages/sketch_parts/0/columns.json"));
  CountingSource again(clip);
  CHECK(same(stages.sketch(again, {}, {}), whole));
  CHECK_FALSE(fs::exists(temp / "run/stages/sketch_parts"));
  CountingSource third(clip);
  CHECK(same(stages.sketch(third, {}, {}), whole));
  CHECK(third.read == 0);
  // Parts of another key are none of this one's.
  const pipeline::AnalysisStages other(temp / "run", {"another", "motion", "model"});
  CountingSource fourth(clip);
  CHECK(same(other.sketch(fourth, {}, {}), whole));
  CHECK(fourth.read > 0);
}

TEST_CASE("an analysis from kept stages is that from the clip, and makes only what is missing", "[heavy]") {
  const auto clip = moving_strokes(14);
  core::ClipSource source(clip);
  const auto options = quick_options();
  const auto plain = pipeline::analyze(source, options);
  const TempFolder temp;
  const auto run = [&](const pipeline::StageKeys& keys) {
    pipeline::AnalysisStages stages(temp / "run", keys);
    int told = 0;
    stages.on_events = [&](const pipeline::Analysis& found, const core::ClipInfo&) {
      CHECK(found.all_events == plain.all_events);
      ++told;
    };
    auto found = pipeline::analyze(source, options, {}, &stages);
    CHECK(told == 1);
    CHECK(found.motion == plain.motion);
    CHECK(found.joints == plain.joints);
    CHECK(found.events == plain.events);
    CHECK(to_archive(found.model).text == to_archive(plain.model).text);
    for (std::size_t i = 0; i < found.rates.size(); ++i) CHECK(found.rates[i].mean == plain.rates[i].mean);
    std::vector<std::string> names;
    for (const auto& stage : found.stages) names.push_back(stage.name);
    return names;
  };
  const auto first = run({"a", "b", "c"}), second = run({"a", "b", "c"}), model_alone = run({"a", "b", "d"}),
             all_but_sketch = run({"a", "e", "f"});
  const auto has = [](const std::vector<std::string>& names, const char* name) {
    return std::ranges::find(names, name) != names.end();
  };
  CHECK(has(first, "match"));
  CHECK_FALSE(has(second, "match"));
  CHECK_FALSE(has(second, "footage"));
  CHECK_FALSE(has(model_alone, "match"));
  CHECK(has(model_alone, "footage"));
  CHECK(has(all_but_sketch, "match"));
}

TEST_CASE("a model that was changed by others is learned again", "[heavy]") {
  const auto clip = moving_strokes(10);
  core::ClipSource source(clip);
  const TempFolder temp;
  const pipeline::AnalysisStages stages(temp / "run", {"a", "b", "c"});
  const auto made = pipeline::analyze(source, quick_options(), {}, &stages);
  REQUIRE(stages.read_model());
  std::ofstream(temp / "run/model/model.json", std::ios::app) << " ";
  CHECK_FALSE(stages.read_model());
  fs::remove_all(temp / "run/model");
  CHECK_FALSE(stages.read_model());
}
