// SPDX-License-Identifier: Apache-2.0
// From pixels to the coefficients of the sway that the built-in clips were made with.
#include <cmath>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/builtin/builtin_clip.hpp"
#include "core/parallel.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

graph::MotionGraph follow(const core::Clip& clip) {
  std::vector<graph::AttributeGraph> graphs(clip.frames.size());
  core::parallel_for(graphs.size(), {}, [&](std::size_t t) {
    graphs[t] = sketch::extract(core::to_levels(clip.frames[t], clip.info), {});
  });
  graph::SketchSequence sketch;
  sketch.width = clip.info.width, sketch.height = clip.info.height, sketch.fps = clip.info.fps;
  for (const auto& graph : graphs) sketch.append(graph);
  return graph::match(std::move(sketch), {});
}

/// The mean over strokes of the two coefficients of their sway.
std::pair<double, double> true_sway(const std::string& truth) {
  std::set<std::pair<double, double>> all;  // as different as strokes are
  const auto json = nlohmann::json::parse(truth);
  for (const auto& frame : json["strokes"])
    for (const auto& stroke : frame)
      if (stroke.contains("ar") && stroke["ar"].size() == 2)
        all.emplace(stroke["ar"][0].get<double>(), stroke["ar"][1].get<double>());
  std::pair<double, double> mean;
  for (const auto& [a1, a2] : all) {
    mean.first += a1 / static_cast<double>(all.size());
    mean.second += a2 / static_cast<double>(all.size());
  }
  return mean;
}

}  // namespace

TEST_CASE("The motion model finds the sway that a built-in clip was made with", "[slow]") {
  const auto scene = GENERATE(apps::BuiltinScene::fire, apps::BuiltinScene::cloth, apps::BuiltinScene::river);
  const auto made = apps::make_builtin({.scene = scene, .seed = 5, .frames = 80});
  const auto [a1, a2] = true_sway(made.truth_json);
  REQUIRE(a1 > 1);
  const auto fitted = mcmc::fit(follow(made.clip));
  CAPTURE(a1, a2, fitted.model.displacement.a1, fitted.model.displacement.a2);
  CHECK(std::abs(fitted.model.displacement.a1 - a1) < 0.1 * std::abs(a1));
  CHECK(std::abs(fitted.model.displacement.a2 - a2) < 0.1 * std::abs(a2));
}
