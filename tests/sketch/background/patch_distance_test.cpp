// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/patch_distance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("The distance from patches is that of the nearest one by straight and slanted steps") {
  const cv::Size size(23, 17);
  const auto pixels = static_cast<std::size_t>(size.area());
  core::Rng rng(4);
  for (const bool faded : {false, true})
    for (int round = 0; round < 10; ++round) {
      std::vector<std::uint8_t> mask(pixels, 0);
      std::vector<float> opacity(pixels, 0), distance(pixels);
      for (int k = 0; k < 1 + round; ++k) {
        const std::size_t at = rng.below(static_cast<std::uint32_t>(pixels));
        mask[at] = 255;
        opacity[at] = static_cast<float>(rng.uniform());
      }
      sketch::distance_from_patches(size, mask.data(), faded ? opacity.data() : nullptr, distance.data());
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          double nearest = 1e9;
          for (int v = 0; v < size.height; ++v)
            for (int u = 0; u < size.width; ++u) {
              const auto i = static_cast<std::size_t>(v * size.width + u);
              if (mask[i] == 0) continue;
              const int across = std::abs(u - x), down = std::abs(v - y);
              const double slanted = std::min(across, down), straight = std::max(across, down) - slanted;
              nearest = std::min(nearest, slanted * double{sketch::kSlantedStep} +
                                              straight * double{sketch::kStraightStep} +
                                              (faded ? 12 * (1 - double{opacity[i]}) : 0));
            }
          const double found = double{distance[static_cast<std::size_t>(y * size.width + x)]};
          if (std::abs(found - nearest) > 1e-3) CHECK_THAT(found, WithinAbs(nearest, 1e-3));
        }
      CHECK(*std::ranges::min_element(distance) >= 0);
    }
}
