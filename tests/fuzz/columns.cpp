// SPDX-License-Identifier: Apache-2.0
// Graphs that a stage left as columns, as one run of bytes: see archive.hpp.
#include <istream>
#include <ostream>
#include <vector>

#include "pipeline/stages/graph_columns.hpp"
#include "tests/fuzz/archive.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto columns_in = [](std::istream& in) { return io::Columns{{}, {}, fuzz::read_archive(in).arrays}; };
  const auto write = [](std::ostream& out, const io::Columns& columns) {
    fuzz::write_archive(out, {{}, columns.arrays, {}});
  };
  fuzz::round_trip(
      data, size, "the column ", [&](std::istream& in) { return pipeline::read_graphs(columns_in(in)); },
      [&](std::ostream& out, const std::vector<graph::AttributeGraph>& graphs) {
        io::Columns columns;
        pipeline::add_graphs(columns, graphs);
        write(out, columns);
      });
  fuzz::round_trip(
      data, size, "the column ", [&](std::istream& in) { return pipeline::read_grounds(columns_in(in)); },
      [&](std::ostream& out, const std::vector<sketch::FrameBackground>& grounds) {
        io::Columns columns;
        pipeline::add_grounds(columns, grounds);
        write(out, columns);
      });
  return fuzz::round_trip(
      data, size, "the column ", [&](std::istream& in) { return pipeline::read_links(columns_in(in)); },
      [&](std::ostream& out, const std::vector<std::vector<graph::Link>>& links) {
        graph::MotionGraph motion;
        motion.links = links;
        io::Columns columns;
        pipeline::add_links(columns, motion);
        write(out, columns);
      });
}
