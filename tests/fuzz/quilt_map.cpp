// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_map.hpp"

#include <vector>

#include "tests/fuzz/check.hpp"

using namespace emberfold;

FUZZ_TARGET(quilt_map)(const std::uint8_t* data, std::size_t size) {
  const std::vector<cv::Size> sources{{40, 30}, {7, 5}};
  return fuzz::round_trip(
      data, size, "",
      [&](std::istream& in) {
        const auto array = core::read_npy(in);
        try {
          return dytex::quilt_map(array, sources);
        } catch (const core::InputError& error) {
          throw core::IoError(error.what());  // both are refusals
        }
      },
      [](std::ostream& out, const dytex::QuiltMap& map) { core::write_npy(out, dytex::to_array(map)); });
}
