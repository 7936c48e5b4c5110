// SPDX-License-Identifier: Apache-2.0
// Graphs that a stage left as columns, as one run of bytes: see archive.hpp.
#include <vector>

#include "pipeline/stages/graph_columns.hpp"
#include "tests/fuzz/archive.hpp"

using namespace emberfold;

FUZZ_TARGET(columns)(const std::uint8_t* data, std::size_t size) {
  const auto check = [&](const auto& read, const auto& add) {
    fuzz::archive_round_trip(
        data, size, "the column ",
        [&](const core::ModelArchive& archive) {
          return read(io::Columns{{}, {}, archive.arrays});
        },
        [&](const auto& value) {
          io::Columns columns;
          add(columns, value);
          return core::ModelArchive{{}, columns.arrays};
        });
  };
  check([](const io::Columns& columns) { return pipeline::read_graphs(columns); }, pipeline::add_graphs);
  check(pipeline::read_grounds, pipeline::add_grounds);
  check(pipeline::read_links, [](io::Columns& columns, const std::vector<std::vector<graph::Link>>& links) {
    pipeline::add_links(columns, links);
  });
  return 0;
}
