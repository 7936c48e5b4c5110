// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/rng.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::test {

inline mcmc::CellMap made_map(int width, int height, double cell, double low, double high) {
  mcmc::CellMap map{
      cell, static_cast<int>(std::ceil(width / cell)), static_cast<int>(std::ceil(height / cell)), {}};
  core::Rng rng(5);
  for (int i = 0; i < map.columns * map.rows; ++i) map.values.push_back(rng.uniform(low, high));
  return map;
}

/// A wavy stroke about (0, 0).
inline graph::AttributeGraph made_shape(std::uint32_t patches, double phase, double contrast,
                                        graph::Point place = {}) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t k = 0; k < patches; ++k) {
    graph::Patch patch;
    patch.type = contrast > 0 ? graph::PatchType::ridge : graph::PatchType::valley;
    patch.position = place + graph::Point{5.0 * k - 2.5 * (patches - 1.0), 4 * std::sin(phase + 0.5 * k)};
    patch.theta = std::atan2(2 * std::cos(phase + 0.5 * k), 5);
    patch.width = 3;
    patch.contrast = contrast;
    patch.left = patch.right = {60, 70, 80};
    for (std::size_t c = 0; c < 3; ++c) patch.middle[c] = patch.left[c] + static_cast<float>(1.15 * contrast);
    vertices.push_back({graph::VertexId{k}, {}, patch});
    if (k > 0) edges.push_back({graph::VertexId{k - 1}, graph::VertexId{k}});
  }
  return {std::move(vertices), std::move(edges)};
}

/// A model as a clip might give it: every number its own.
inline mcmc::MotionModel made_model(int width, int height, double cell) {
  mcmc::MotionModel model;
  model.width = width, model.height = height, model.fps = 25, model.frames = 50;
  model.displacement = {1.31, -0.52, 0.1, 0.4, 12, 0.15};
  model.displacement_scale = made_map(width, height, cell, 0.7, 1.3);
  model.contrast = {0.83, 0.04, 0.05, 0.08, 8, 0.02};
  model.drift_x = made_map(width, height, cell, -0.3, 0.3);
  model.drift_y = made_map(width, height, cell, -0.9, -0.2);
  model.rates.birth = made_map(width, height, cell, 0.5e-5, 4e-5);
  model.rates.death = made_map(width, height, cell, 0.6, 1.4);
  model.rates.separation = made_map(width, height, cell, 0.8, 1.2);
  model.density = made_map(width, height, cell, 2, 9);
  model.rates.birth_by_size = {0.2, 0.5, 0.3, 0, 0, 0, 0};
  model.rates.death_by_size = {0.08, 0.05, 0.03, 0.02, 0.01, 0.01, 0.01};
  model.rates.split = 0.002, model.rates.merge = 0.01, model.rates.connect = 0.004,
  model.rates.disconnect = 0.005;
  model.appearing = {0.5, 0.7, 0.85, 0.95, 1, 1, 1, 1};
  model.vanishing = {0.6, 0.8, 0.9, 1, 1, 1, 1, 1};
  for (std::uint32_t i = 0; i < 6; ++i)
    model.exemplars.push_back(
        {made_shape(4 + 2 * i, 0.7 * i, i % 2 == 0 ? 60 : -30), {20.0 + 5 * i, 30}, 12});
  model.first = made_shape(8, 0.3, 50, {width / 2.0, height / 2.0});
  return model;
}

}  // namespace emberfold::test
