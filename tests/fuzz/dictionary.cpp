// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include "sketch/dictionary/dictionary.hpp"

#include <istream>
#include <ostream>

#include "tests/fuzz/archive.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size,
      "dictionary: ", [](std::istream& in) { return sketch::read_dictionary(fuzz::read_archive(in)); },
      [](std::ostream& out, const sketch::Dictionary& dictionary) {
        fuzz::write_archive(out, sketch::to_archive(dictionary));
      });
}
