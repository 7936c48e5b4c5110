// SPDX-License-Identifier: Apache-2.0
// All of a motion model's folder, as one run of bytes: see archive.hpp.
#include "pipeline/clip_model.hpp"

#include "tests/fuzz/archive.hpp"

using namespace emberfold;

FUZZ_TARGET(clip_model)(const std::uint8_t* data, std::size_t size) {
  return fuzz::archive_round_trip(
      data, size,
      "motion model: ", [](const core::ModelArchive& archive) { return pipeline::clip_model(archive); },
      [](const auto& value) { return pipeline::to_archive(value); });
}
