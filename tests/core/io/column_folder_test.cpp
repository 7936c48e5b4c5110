// SPDX-License-Identifier: Apache-2.0
#include "core/io/column_folder.hpp"

#include <cstdint>
#include <filesystem>
#include <numeric>
#include <vector>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

core::NpyArray pairs(double first, std::size_t rows) {
  std::vector<double> values(2 * rows);
  std::iota(values.begin(), values.end(), first);
  return {{rows, 2}, false, values};
}

}  // namespace

TEST_CASE("Columns that are written row after row are those that are written at once", "[io]") {
  const TempFolder temp;
  const core::NpyArray names{{3}, false, std::vector<std::uint8_t>{4, 5, 6}};
  io::write_columns(temp / "whole", {"key", "text", {{"pairs", pairs(0, 1012)}, {"names", names}}});
  io::ColumnWriter writer(temp / "parts");
  writer.append({{"pairs", pairs(0, 7)}});
  writer.append({{"names", names}, {"pairs", pairs(14, 0)}});
  writer.append({{"pairs", pairs(14, 1005)}});
  CHECK_FALSE(std::filesystem::exists(temp / "parts"));
  writer.finish("key", "text");
  for (const char* name : {"pairs.npy", "names.npy", "columns.json"}) {
    INFO(name);
    CHECK(bytes_of(temp / "parts" / name) == bytes_of(temp / "whole" / name));
  }
  const auto read = io::read_columns(temp / "parts", "key");
  REQUIRE(read);
  CHECK(read->arrays.at("pairs") == pairs(0, 1012));
}

TEST_CASE("Columns that are not finished leave nothing, and rows of other shapes are refused", "[io]") {
  const TempFolder temp;
  {
    io::ColumnWriter writer(temp / "parts");
    writer.append({{"pairs", pairs(0, 7)}});
    CHECK_THROWS_AS(writer.append({{"pairs", {{3}, false, std::vector<double>{1, 2, 3}}}}), core::InputError);
    CHECK_THROWS_AS(writer.append({{"pairs", {{1, 2}, false, std::vector<float>{1, 2}}}}), core::InputError);
  }
  CHECK(std::filesystem::is_empty(temp.path()));
}
