// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/clip_strokes.hpp"

#include <cmath>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("frames of a series of strokes are those asked for, with the gaps between them") {
  mcmc::StrokeSeries series;
  for (int t = 0; t < 10; ++t) {
    series.strokes.push_back(t), series.ended.push_back(100 + t), series.length.push_back(200 + t);
    if (t == 0) continue;  // events of the gap before frame t
    for (std::size_t type = 0; type < 6; ++type)
      series.events[type].push_back(1000 * static_cast<double>(type) + t);
  }
  const auto part = pipeline::select_frames(series, 3, 7);
  CHECK(part.strokes == std::vector<double>{3, 4, 5, 6});
  CHECK(part.ended == std::vector<double>{103, 104, 105, 106});
  CHECK(part.length == std::vector<double>{203, 204, 205, 206});
  for (std::size_t type = 0; type < 6; ++type) {
    const double first = 1000 * static_cast<double>(type);
    CHECK(part.events[type] == std::vector<double>{first + 4, first + 5, first + 6});
  }
}

TEST_CASE("rates of events are by gaps between frames, half an event added to each count") {
  mcmc::StrokeStatistics few, many;
  few.frames = 5, many.frames = 101;
  for (std::size_t type = 0; type < 6; ++type) few.happened[type] = 1.5, many.happened[type] = 49.5;
  CHECK_THAT(pipeline::stroke_distances(few, many).event_rates, test::WithinAbs(0, 1e-12));
  many.happened[2] = 199.5;  // four times as often
  CHECK_THAT(pipeline::stroke_distances(few, many).event_rates,
             test::WithinAbs(std::log(4) / std::sqrt(6), 1e-12));
}
