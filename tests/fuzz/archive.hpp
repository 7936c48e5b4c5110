// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: model.json up to the first zero byte, then arrays, each a name, a line
// break and a .npy file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <ostream>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/model_archive.hpp"
#include "tests/fuzz/check.hpp"

namespace emberfold::fuzz {

inline core::ModelArchive read_archive(std::istream& in) {
  core::ModelArchive archive;
  std::getline(in, archive.text, '\0');
  std::string name;
  while (std::getline(in, name)) {
    try {
      archive.arrays[name] = core::read_npy(in, 1 << 20);
    } catch (const core::IoError&) {
      break;  // another target's matter
    }
  }
  return archive;
}

inline void write_archive(std::ostream& out, const core::ModelArchive& archive) {
  out << archive.text << '\0';
  for (const auto& [name, array] : archive.arrays) {
    out << name << '\n';
    core::write_npy(out, array);
  }
}

/// round_trip() of what `read` makes of an archive and `write` makes one of.
template <typename Read, typename Write>
int archive_round_trip(const std::uint8_t* data, std::size_t size, std::string_view prefix, Read read,
                       Write write) {
  return round_trip(
      data, size, prefix, [&](std::istream& in) { return read(read_archive(in)); },
      [&](std::ostream& out, const auto& value) { write_archive(out, write(value)); });
}

}  // namespace emberfold::fuzz
