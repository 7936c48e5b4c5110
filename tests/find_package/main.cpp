// SPDX-License-Identifier: Apache-2.0
// Uses something of every library, by the headers as they are installed; returns 0 where all is right.
#include <cmath>
#include <iostream>
#include <sstream>

#include <opencv2/core.hpp>

#include "core/npy.hpp"
#include "core/parallel.hpp"
#include "dytex/learn.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/synthesize.hpp"
#include "graph/attribute_graph.hpp"
#include "graph/io/motion_io.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "sketch/inpainting/fill.hpp"

using namespace emberfold;

namespace {

bool check(bool right, const char* what) {
  std::cout << (right ? "right: " : "WRONG: ") << what << '\n';
  return right;
}

}  // namespace

int main() {
  bool right =
      check(core::deterministic_sum(101, 8, [](std::size_t i) { return static_cast<double>(i); }) == 5050,
            "core sums");

  const core::NpyArray array{{2}, false, std::vector<float>{1, 2}};
  std::stringstream npy;
  core::write_npy(npy, array);
  right &= check(core::read_npy(npy) == array, "core writes and reads .npy");

  std::vector<graph::Vertex> vertices(3);
  for (std::uint32_t i = 0; i < 3; ++i) vertices[i].id = {i + 1};
  const graph::AttributeGraph two_strokes(vertices, {{{1}, {3}}});
  right &= check(graph::components(two_strokes).count == 2, "graph finds components");

  graph::SketchSequence sketch{8, 4, 25, {two_strokes}};
  std::stringstream lines;
  graph::write_sketch(lines, sketch);
  right &= check(graph::read_sketch(lines, "the sketch") == sketch, "graph writes and reads JSON Lines");

  // Two frames of a graph that stands still: as many patches in every frame drawn from its model.
  graph::MotionGraph motion;
  motion.sketch.width = 64, motion.sketch.height = 48;
  for (int t = 0; t < 2; ++t) motion.sketch.append(two_strokes);
  motion.links = {{}, {{{0}, {3}}, {{1}, {4}}, {{2}, {5}}}};
  const auto model = mcmc::motion_model(mcmc::to_archive(mcmc::fit(graph::identify(motion)).model));
  right &= check(mcmc::Synthesis(model, 1).next().size() == 3, "mcmc learns and draws a graph");

  // Two pixels that take turns: one component, and a model that can be kept.
  core::Clip clip{{2, 1, 1, CV_8U, 25, 255, 4}, {}};
  for (int t = 0; t < 4; ++t)
    clip.frames.push_back((cv::Mat_<unsigned char>(1, 2) << t % 2 * 9, 9 - t % 2 * 9));
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.components = 1;
  const dytex::LinearDynamicTexture texture =
      dytex::linear_dynamic_texture(dytex::to_archive(dytex::learn(source, options).texture));
  dytex::Synthesis synthesis(texture, {});
  right &= check(texture.order() == 1 && synthesis.next().cols == 2, "dytex learns, keeps and draws");

  // Between 0 and 10 heat settles in the middle.
  const cv::Mat levels = (cv::Mat_<float>(1, 3) << 0.0F, 99.0F, 10.0F);
  const cv::Mat mask = (cv::Mat_<unsigned char>(1, 3) << 255, 0, 255);
  const sketch::FillResult filled = sketch::fill(levels, mask);
  right &= check(filled.converged && std::abs(filled.levels.at<float>(0, 1) - 5.0F) < 0.25F, "sketch fills");
  return right ? 0 : 1;
}
