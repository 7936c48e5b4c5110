// SPDX-License-Identifier: Apache-2.0
// Steps of every fuzz target: a reader accepts the bytes or refuses them with one clear line. Accepted
// content survives writing and reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

#include "core/error.hpp"

// FUZZ_TARGET(npy)(data, size) { … } defines the entry point of libFuzzer, or one of the readers of
// replay.cpp.
#ifdef EMBERFOLD_REPLAY
#define FUZZ_TARGET(name)                                                                           \
  static int fuzz_##name(const std::uint8_t* data, std::size_t size);                               \
  static const bool replays_##name = emberfold::fuzz::readers().emplace(#name, fuzz_##name).second; \
  static int fuzz_##name
#else
#define FUZZ_TARGET(name) extern "C" int LLVMFuzzerTestOneInput
#endif

namespace emberfold::fuzz {

/// Returns the readers that replay.cpp knows, by name.
inline std::map<std::string, int (*)(const std::uint8_t*, std::size_t)>& readers() {
  static std::map<std::string, int (*)(const std::uint8_t*, std::size_t)> all;
  return all;
}

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
