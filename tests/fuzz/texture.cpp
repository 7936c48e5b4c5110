// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: see archive.hpp.
#include <istream>
#include <ostream>

#include "dytex/model/archive.hpp"
#include "tests/fuzz/archive.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size,
      "model: ", [](std::istream& in) { return dytex::linear_dynamic_texture(fuzz::read_archive(in)); },
      [](std::ostream& out, const dytex::LinearDynamicTexture& texture) {
        fuzz::write_archive(out, dytex::to_archive(texture));
      });
}
