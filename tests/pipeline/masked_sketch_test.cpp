// SPDX-License-Identifier: Apache-2.0
#include "pipeline/masked_sketch.hpp"

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("A mask leaves out patches by their own pixel, and what only joined them") {
  graph::Patch patch;
  patch.width = 2, patch.contrast = 20;
  const auto at = [&](std::uint32_t id, double x, double y) {
    patch.position = {x, y};
    return graph::Vertex{{id}, {}, patch};
  };
  cv::Mat mask(40, 60, CV_8U, cv::Scalar(0));
  mask.rowRange(0, 20).setTo(255);  // the upper half
  const graph::AttributeGraph graph({at(0, 50, 8), at(1, 50, 12), at(2, 8, 30), at(3, 40, 19), at(4, 40, 24)},
                                    {{{0}, {1}}, {{3}, {4}}});
  const auto left = pipeline::inside_mask(graph, mask);
  REQUIRE(left.size() == 2);  // vertex 3 has no neighbour inside
  CHECK(left.vertices()[0].id == graph::VertexId{0});
  CHECK(left.vertices()[1].id == graph::VertexId{1});
  CHECK(left.edges().size() == 1);
}
