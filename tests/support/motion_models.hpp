// SPDX-License-Identifier: Apache-2.0
// Motion models by hand.
#pragma once

#include <cmath>

#include "mcmc/model/motion_model.hpp"
#include "tests/support/graphs.hpp"

namespace emberfold::test {

inline mcmc::CellMap map_over(int width, int height, double cell, double value) {
  mcmc::CellMap map;
  map.cell = cell;
  map.columns = static_cast<int>(std::ceil(width / cell));
  map.rows = static_cast<int>(std::ceil(height / cell));
  map.values.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), value);
  return map;
}

/// Nothing moves, nothing happens, nothing is there; what is born would be at full contrast at once.
inline mcmc::MotionModel empty_model(int width = 320, int height = 240) {
  mcmc::MotionModel model;
  model.width = width, model.height = height, model.frames = 2;
  const auto zero = map_over(width, height, 16, 0), one = map_over(width, height, 16, 1);
  model.drift_x = model.drift_y = model.rates.birth = model.density = zero;
  model.rates.death = model.rates.separation = model.displacement_scale = one;
  model.appearing.fill(1);
  model.vanishing.fill(1);
  return model;
}

/// A stroke about (0, 0) of patches 5 px apart.
inline graph::AttributeGraph straight(int patches, double theta = 0, double contrast = 40) {
  const graph::Point half = graph::Point{std::cos(theta), std::sin(theta)} * (2.5 * (patches - 1));
  test::Frame frame;
  frame.line(test::segment(half * -1, half, patches), contrast);
  return frame.graph();
}

/// Strokes of so many patches are born at 60 places all over a large frame, and die.
inline mcmc::MotionModel coming_and_going(int patches, double clearance, double density, double death) {
  auto model = empty_model(640, 480);
  for (int i = 0; i < 60; ++i)
    model.exemplars.push_back({straight(patches), {40 + 62.0 * (i % 10), 40 + 80.0 * (i / 10)}, clearance});
  model.rates.birth_by_size[mcmc::size_class(static_cast<std::size_t>(patches))] = 1;
  for (double& value : model.rates.birth.values) value = 2.0 / (640 * 480);
  for (double& value : model.density.values) value = density;
  model.rates.death_by_size.fill(death);
  return model;
}

/// Every part another number, so that none can stand in for another.
inline mcmc::MotionModel full_model() {
  auto model = empty_model(100, 60);  // 7 x 4 cells
  model.fps = 29.97, model.frames = 77;
  model.displacement = {1.5, -0.6, 0.05, 0.3, 21, 0.1};
  model.contrast = {0.7, 0.1, 0.02, 0.05, 9, 0.01};
  auto& r = model.rates;
  double value = 0.001;
  for (auto* map : {&model.drift_x, &model.drift_y, &r.birth, &model.density, &r.death, &r.separation,
                    &model.displacement_scale})
    for (double& cell : map->values) cell = value *= 1.02;
  model.drift_x.values[3] = -0.25;
  model.velocity = {2, {}, {0.6, 0, 0, 0.8}, {0.8, 0, 0, 0.6}};
  for (std::size_t i = 0; i < 4 * model.drift_x.values.size(); ++i)
    model.velocity.modes.push_back(value *= 1.01);
  r.birth_by_size = {0.1, 0.2, 0.3, 0.15, 0.15, 0.06, 0.04};
  r.death_by_size = {0.3, 0.2, 0.1, 0.05, 0.04, 0.03, 0.02};
  r.split = 0.011, r.merge = 0.012, r.connect = 0.013, r.disconnect = 0.014;
  r.reach = 23, r.split_gap = 11, r.disconnect_gap = 12, r.refractory_period = 3;
  r.modifiers = {{0.1, 0.9, 1.1, 1.2, 1.3, 1.4}, {1.5, 0.6, 0.7, 0.8, 1.6, 1.7},
                 {1.8, 1.9, 0.4, 0.3, 0.2, 2.1}, {2.2, 2.3, 2.4, 0.5, 2.5, 2.6},
                 {2.7, 2.8, 0.35, 0.15},         1.5};
  model.hard_core = {8, 2.5, 1.5};
  model.appearing = {0.1, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
  model.vanishing = {0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 1, 1};
  model.exemplars.push_back({straight(5, 0.3, -20), {20.5, 30}, 11});
  model.exemplars.push_back({straight(9, 1.3), {70, 33.25}, 1000});
  test::Frame t;
  t.line(test::segment({10, 20}, {60, 20}, 11));
  t.line(test::segment({35, 25}, {35, 50}, 6), 25);
  t.edge(5, 11);
  for (auto& v : t.vertices) v.patch.blur = 1.25, v.patch.left = {1, 2, 3};
  t.vertices[5].patch.type = graph::PatchType::t_junction;
  model.first = t.graph();
  return model;
}

}  // namespace emberfold::test
