// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/surface_layout.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

namespace {

// A surface that was read can be laid out, or is refused.
dytex::UvMesh read_and_lay_out(std::istream& in) {
  auto mesh = dytex::read_obj(in, "file");
  try {
    const auto layout = dytex::lay_out_surface(mesh, {40, 30});
    if (layout.covered < 1 || layout.chart_count < 1) fuzz::broken("a layout of nothing");
  } catch (const core::InputError& error) {
    fuzz::check_message(error.what(), "the surface");
  }
  return mesh;
}

}  // namespace

FUZZ_TARGET(obj)(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(data, size, "file", read_and_lay_out, dytex::write_obj);
}
