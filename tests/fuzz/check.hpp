// SPDX-License-Identifier: Apache-2.0
// Steps of every fuzz target: a reader accepts the bytes or refuses them with one clear line. Accepted
// content survives writing and reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

#include "core/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace emberfold::fuzz {

/// The fuzzers take an abort for a finding.
[[noreturn]] inline void broken(const std::string& what) {
  std::fprintf(stderr, "broken promise: %s\n", what.c_str());
  std::abort();
}

/// A message begins with `prefix` and is one short line of printable text.
inline void check_message(std::string_view message, std::string_view prefix) {
  if (!message.starts_with(prefix))
    broken("a message without '" + std::string(prefix) + "': " + std::string(message));
  if (message.size() > 500) broken("a message of " + std::to_string(message.size()) + " bytes");
  for (const char c : message)
    if (static_cast<unsigned char>(c) < ' ') broken("a control character in: " + std::string(message));
}

/// `read` takes a stream and gives a value; `write` puts a value on a stream. Reading what was written gives
/// the same value, told by what is written of it.
template <typename Read, typename Write>
int round_trip(const std::uint8_t* data, std::size_t size, std::string_view prefix, Read read, Write write) {
  const auto written = [&](const auto& value) {
    std::ostringstream out;
    write(out, value);
    return out.str();
  };
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  std::string bytes;
  try {
    bytes = written(read(in));
  } catch (const core::IoError& error) {
    check_message(error.what(), prefix);
    return 0;
  }
  std::istringstream again(bytes);
  try {
    if (written(read(again)) != bytes) broken("what was written reads back differently");
  } catch (const core::IoError& error) {
    broken(std::string("what was written cannot be read: ") + error.what());
  }
  return 0;
}

}  // namespace emberfold::fuzz
