// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include "mcmc/model/motion_model.hpp"

#include <istream>
#include <ostream>

#include "tests/fuzz/archive.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size,
      "motion model: ", [](std::istream& in) { return mcmc::motion_model(fuzz::read_archive(in)); },
      [](std::ostream& out, const mcmc::MotionModel& model) {
        fuzz::write_archive(out, mcmc::to_archive(model));
      });
}
