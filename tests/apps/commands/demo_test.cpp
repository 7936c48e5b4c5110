// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("demo makes its clip, and what it scores is what the score command says of its files", "[slow]") {
  const TempFolder temp;
  const auto out = temp / "demo";
  const auto result = run_command({"demo", "-o", out.string(), "--clip", "cloth", "--seed", "3"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  CHECK(contains(result.err, (out / "report.html").string()));
  const auto score =
      run_command({"score", (out / "truth.json").string(), (out / "events.json").string(), "--json"});
  REQUIRE(score.exit == 0);
  const Json again = Json::parse(score.out), told = Json::parse(bytes_of(out / "score.json"));
  CHECK(told["four"] == again["four"]);
  CHECK(told["six"] == again["six"]);
  CHECK(told["four"]["all"]["true"] > 0);
  const auto clip = core::read_all(*apps::open_clip((out / "clip.avi").string(), {}, {}));
  const Json summary = summary_of(out);
  CHECK(clip.frames.size() == summary["clip"]["frames"]);
  // the whole story: both models, a clip drawn from each, how close they come, all on one page
  for (const auto& [name, about] : summary["files"].items()) CHECK(fs::exists(out / name));
  for (const char* name : {"synthesized_footage.avi", "synthesized_strokes.avi", "synthesized_motion.avi",
                           "synthesized_dytex.avi", "edited_splits.avi", "edited_births.avi",
                           "edited_wind.avi", "edited_slower.avi", "edited_backwards.avi"}) {
    const auto made = core::read_all(*apps::open_clip((out / name).string(), {}, {}));
    CHECK(made.frames.size() == clip.frames.size());
    CHECK(made.frames[0].size() == clip.frames[0].size());
  }
  const Json measures = Json::parse(bytes_of(out / "measures.json"));
  CHECK(summary["comparison"]["synthesis"] == measures["synthesis"]);
  CHECK(summary["comparison"]["prediction"]["methods"] == measures["prediction"]["methods"]);
  CHECK(summary["texture"]["spectral_radius"] < 1);
  CHECK_FALSE(fs::exists(out / "strip.mp4"));
  const auto page = bytes_of(out / "report.html");
  CHECK(page.size() < 8'000'000);
  for (const char* part :
       {"\"clips\":{\"names\":[\"Source\",\"Clip's footage\",\"Clip's strokes\",\"Motion "
        "model\",\"Linear dynamic texture\",\"Twice the splits\",\"Half the births\",\"In the "
        "wind\",\"Half as fast\",\"Backwards\"]",
        "\"measures\":{", "\"eigenvalues\":[", "\"learned\":{\"motion\":{"})
    CHECK(contains(page, part));
  check_one_line({"demo", "-o", (temp / "other").string(), "--clip", "water"}, 2,
                 {"--clip", "water", "cloth"}, temp / "other");
}
