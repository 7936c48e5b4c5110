// SPDX-License-Identifier: Apache-2.0
#include "apps/runs/run_estimate.hpp"

#include <opencv2/imgproc.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold;
using Catch::Matchers::WithinRel;

namespace {

/// A clip of black frames, and from frame `lit` on with ten bright lines.
core::Clip lit_clip(int frames, int lit) {
  core::Clip clip;
  clip.info.width = 160, clip.info.height = 120, clip.info.channels = 3, clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(120, 160, CV_8UC3, cv::Scalar::all(0));
    for (int x = 10; t >= lit && x < 160; x += 15)
      cv::line(frame, {x, 10}, {x, 110}, cv::Scalar::all(200), 3, cv::LINE_AA);
    clip.frames.push_back(frame);
  }
  return clip;
}

apps::RunEstimate estimate(const core::Clip& clip) {
  core::ClipSource source(clip);
  auto found = apps::estimate_run(source, {}, 1);
  CHECK(cv::norm(source.next(), clip.frames[0], cv::NORM_INF) == 0);  // rewound
  REQUIRE(found);
  return *found;
}

}  // namespace

TEST_CASE("a run is estimated by what frames show after a dark beginning", "[run_estimate]") {
  const auto lit = estimate(lit_clip(12, 0)), dark = estimate(lit_clip(12, 3)),
             black = estimate(lit_clip(12, 12));
  CHECK(lit.disk_mb > 0.5);
  CHECK_THAT(dark.disk_mb, WithinRel(lit.disk_mb, 1e-9));
  CHECK(black.disk_mb == 0);
  CHECK(black.memory_mb > 100);
  CHECK_THAT(estimate(lit_clip(24, 0)).disk_mb, WithinRel(2 * lit.disk_mb, 1e-9));
  CHECK(estimate(lit_clip(2, 0)).frames == 2);
  const auto one = lit_clip(1, 0);
  core::ClipSource source(one);
  CHECK_FALSE(apps::estimate_run(source, {}, 1));
}
