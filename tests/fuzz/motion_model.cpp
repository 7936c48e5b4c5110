// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include "mcmc/model/motion_model.hpp"

#include "tests/fuzz/archive.hpp"

using namespace emberfold;

FUZZ_TARGET(motion_model)(const std::uint8_t* data, std::size_t size) {
  return fuzz::archive_round_trip(
      data, size,
      "motion model: ", [](const core::ModelArchive& archive) { return mcmc::motion_model(archive); },
      [](const auto& value) { return mcmc::to_archive(value); });
}
