// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_words.hpp"

#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold::apps;
using OrderedJson = nlohmann::ordered_json;

TEST_CASE("the words name who wins and who loses") {
  const OrderedJson measures = OrderedJson::parse(R"({
    "models": [{"key": "motion_model", "label": "motion model"}, {"key": "star", "label": "STAR model"}],
    "prediction": {"steps": [1, 4], "methods": {
      "motion_model": {"by_step": {"psnr": [25.0, 18.0]}}, "star": {"by_step": {"psnr": [24.0, 20.0]}},
      "frame_before": {"by_step": {"psnr": [26.0, 17.0]}}, "mean_image": {"by_step": {"psnr": [20.5, 21.0]}}}},
    "synthesis": {"motion_model": {"temporal_db": 1.0, "radial_db": 8.0, "inside": {"birth": true, "death": false}},
      "star": {"temporal_db": 6.0, "radial_db": 2.0}, "noise_floor": {"temporal_db": 1.1, "radial_db": 0.5}}})");
  const auto words = comparison_words(measures);
  REQUIRE(words.size() == 5);
  const auto tells = [&](std::size_t i, const std::string& part) {
    INFO(words[i]);
    CHECK(words[i].find(part) != std::string::npos);
  };
  tells(0,
        "motion model is nearest to the source in spectrum in time; it is the farthest in spectrum in space");
  tells(0, "In spectrum in time it lies about as near");
  tells(1, "STAR model is nearest to the source in spectrum in space");
  tells(1, "By every measure the source's own halves are more alike");
  tells(2,
        "motion model predicts the next frame best, at 25.0 dB, behind showing the frame before again (26.0 "
        "dB)");
  tells(3,
        "STAR model predicts best 4 frames ahead, at 20.0 dB, behind the mean image of the first "
        "part (21.0 dB)");
  tells(4, "1 of 2 figures of strokes");
  tells(4, "outside: deaths.");
  CHECK(at_floor(1.2, 1.0));
  CHECK_FALSE(at_floor(1.4, 1.0));
}

TEST_CASE("the verdict comes first: what is least apart from the source to the eye, beside the loop") {
  const auto visible = [](double complete, double apart, double copied) {
    return OrderedJson{{"visible",
                        {{"complete", complete},
                         {"coherent", 1.1},
                         {"flow", 0.9},
                         {"variance", 1},
                         {"difference", 1},
                         {"copied", copied},
                         {"moves_alike", apart < 1},
                         {"apart", apart}}}};
  };
  OrderedJson measures = {{"models",
                           {{{"key", "footage"}, {"label", "clip's footage"}},
                            {{"key", "star"}, {"label", "STAR model"}},
                            {{"key", "video_loop"}, {"label", "video-texture loop"}}}}};
  measures["synthesis"] = {{"footage", visible(1.04, 0.3, 0.46)},
                           {"star", visible(1.01, 0.8, 0.1)},
                           {"video_loop", visible(0.9, 0, 1)}};
  CHECK(
      comparison_words(measures).front() ==
      "To the eye the new clip of the clip's footage is nearest to the source: completeness 1.04 and "
      "coherence "
      "1.10 (1 as the source's own halves), 0.90 of its flow, 1.00 of its variance, 1.00 of its change from "
      "frame to frame; 46 % of what moves is as in one frame of it. The loop of the clip itself, the peer to "
      "beat, has completeness 0.90 and is copied by 100 %.");
  measures["synthesis"]["footage"] = visible(1.04, 1.7, 0.46);
  measures["synthesis"]["star"] = visible(1.01, 1.2, 0.46);
  CHECK(comparison_words(measures).front().starts_with(
      "To the eye the new clip of the STAR model is nearest to the source, though none moves as it does: "));
}
