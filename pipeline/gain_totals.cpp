// SPDX-License-Identifier: Apache-2.0
#include "pipeline/gain_totals.hpp"

#include "sketch/refinement/coding_length.hpp"

namespace emberfold::pipeline {

void GainTotals::add(const GainTotals& other) {
  nats += other.nats;
  patches += other.patches;
  positive += other.positive;
}

GainTotals total_gain(const cv::Mat& levels, const graph::AttributeGraph& graph) {
  GainTotals totals;
  if (graph.empty()) return totals;
  const auto frame = sketch::prepare_coding(levels);
  for (const auto& vertex : graph.vertices()) {
    const double gain = sketch::coding_gain(frame, vertex.patch);
    totals.nats += gain;
    totals.positive += gain > 0 ? 1 : 0;
    ++totals.patches;
  }
  return totals;
}

}  // namespace emberfold::pipeline
