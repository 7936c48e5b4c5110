// SPDX-License-Identifier: Apache-2.0
// All of a motion model's folder but its texture, as one run of bytes: see archive.hpp.
#include "pipeline/clip_model.hpp"

#include <istream>
#include <ostream>

#include "tests/fuzz/archive.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size,
      "motion model: ", [](std::istream& in) { return pipeline::clip_model(fuzz::read_archive(in)); },
      [](std::ostream& out, const pipeline::ClipModel& model) {
        fuzz::write_archive(out, pipeline::to_archive(model));
      });
}
