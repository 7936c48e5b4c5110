// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include "dytex/model/archive.hpp"
#include "tests/fuzz/archive.hpp"

using namespace emberfold;

FUZZ_TARGET(texture)(const std::uint8_t* data, std::size_t size) {
  return fuzz::archive_round_trip(
      data, size,
      "model: ", [](const core::ModelArchive& archive) { return dytex::linear_dynamic_texture(archive); },
      [](const auto& value) { return dytex::to_archive(value); });
}
