// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

#include "apps/draw.hpp"
#include "mcmc/synthesize.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

bool is_grey(const graph::AttributeGraph& graph) {
  const auto same = [](const graph::Level& l) { return l[0] == l[1] && l[1] == l[2]; };
  return std::ranges::all_of(graph.vertices(), [&](const graph::Vertex& v) {
    return same(v.patch.left) && same(v.patch.middle) && same(v.patch.right);
  });
}

double mean(const std::vector<std::size_t>& values) {
  const double sum = static_cast<double>(std::accumulate(values.begin(), values.end(), std::size_t{0}));
  return std::round(100 * sum / static_cast<double>(std::max<std::size_t>(1, values.size()))) / 100;
}

}  // namespace

FrameLook model_look(const mcmc::MotionModel& model, Ground ground, const sketch::FillOptions& fill) {
  FrameLook look{{model.width, model.height}, std::max(1, ground.levels.channels()), 0, fill, {}};
  look.ground = std::move(ground);
  double sum = 0, count = 0;
  const auto look_at = [&](const graph::AttributeGraph& graph) {
    if (!is_grey(graph)) look.channels = 3;
    for (const auto& vertex : graph.vertices())
      for (const auto* side : {&vertex.patch.left, &vertex.patch.right}) {
        sum += 0.114 * double{(*side)[0]} + 0.587 * double{(*side)[1]} + 0.299 * double{(*side)[2]};
        ++count;
      }
  };
  look_at(model.first);
  for (const auto& exemplar : model.exemplars) look_at(exemplar.graph);
  if (count > 0) look.empty_level = static_cast<float>(sum / count);
  return look;
}

Json SynthesisFigures::json() const {
  Json counts = Json::object();
  for (std::size_t i = 0; i < operators.size(); ++i)
    counts[std::string(graph::name(all_event_types()[i]))] = operators[i];
  return {{"patches_per_frame", mean(patches)}, {"strokes_per_frame", mean(strokes)}, {"operators", counts}};
}

SynthesisFigures draw_model(const mcmc::MotionModel& model, int frames, std::uint64_t seed,
                            const FrameLook& look, const core::Context& context,
                            const std::function<void(int, const cv::Mat&)>& take, mcmc::Start start) {
  SynthesisFigures figures;
  mcmc::Synthesis synthesis(model, seed, start);
  draw_frames(
      frames, look, "synthesize", context,
      [&](int) {
        auto graph = synthesis.next();
        figures.patches.push_back(graph.size());
        figures.strokes.push_back(graph::components(graph).count);
        for (std::size_t i = 0; i < figures.operators.size(); ++i)
          figures.operators[i] += static_cast<std::size_t>(synthesis.operators()[i]);
        return graph;
      },
      take);
  return figures;
}

}  // namespace emberfold::apps
