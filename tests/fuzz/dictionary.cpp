// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include "sketch/dictionary/dictionary.hpp"

#include "tests/fuzz/archive.hpp"

using namespace emberfold;

FUZZ_TARGET(dictionary)(const std::uint8_t* data, std::size_t size) {
  return fuzz::archive_round_trip(
      data, size,
      "dictionary: ", [](const core::ModelArchive& archive) { return sketch::read_dictionary(archive); },
      [](const auto& value) { return sketch::to_archive(value); });
}
