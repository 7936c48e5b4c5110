// SPDX-License-Identifier: Apache-2.0
#include "pipeline/parameter_count.hpp"

namespace emberfold::pipeline {

namespace {

double numbers(const graph::AttributeGraph& graph) {
  // Position, direction, width, blur, contrast, three levels of three channels; type. An edge: its two ends.
  constexpr double kPatch = 16, kEdge = 2;
  return kPatch * static_cast<double>(graph.size()) + kEdge * static_cast<double>(graph.edges().size());
}

}  // namespace

double parameter_count(const graph::SketchSequence& sketch) {
  double sum = 0;
  for (const auto& graph : sketch.frames) sum += numbers(graph);
  return sum;
}

double parameter_count(const mcmc::MotionModel& model) {
  constexpr double kScalars = 6 + 6 + 16 + 8;
  const auto& velocity = model.velocity;
  double sum = kScalars + numbers(model.first) + 2.0 * mcmc::kSizeClasses +
               static_cast<double>(velocity.modes.size() + velocity.step.size() + velocity.noise.size());
  for (const auto& exemplar : model.exemplars) sum += numbers(exemplar.graph) + 3;
  for (const auto* map : {&model.displacement_scale, &model.drift_x, &model.drift_y, &model.rates.birth,
                          &model.rates.death, &model.rates.separation, &model.density})
    sum += static_cast<double>(map->values.size());
  return sum;
}

double parameter_count(const dytex::LinearDynamicTexture& texture) {
  return static_cast<double>(texture.mean.size() + texture.C.size() + texture.A.size() + texture.B.size());
}

}  // namespace emberfold::pipeline
