// SPDX-License-Identifier: Apache-2.0
// An archive as one run of bytes: model.json up to the first zero byte, then arrays, each a name, a line
// break and a .npy file.
#include "mcmc/motion_model.hpp"

#include <istream>
#include <ostream>

#include "core/error.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

namespace {

core::ModelArchive read_archive(std::istream& in) {
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

void write_archive(std::ostream& out, const core::ModelArchive& archive) {
  out << archive.text << '\0';
  for (const auto& [name, array] : archive.arrays) {
    out << name << '\n';
    core::write_npy(out, array);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size, "motion model: ", [](std::istream& in) { return mcmc::motion_model(read_archive(in)); },
      [](std::ostream& out, const mcmc::MotionModel& model) { write_archive(out, mcmc::to_archive(model)); });
}
