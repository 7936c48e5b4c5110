// SPDX-License-Identifier: Apache-2.0
#include "core/io/mapped_memory.hpp"

#include <cstring>
#include <filesystem>
#include <map>
#include <memory_resource>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("Blocks in mapped memory keep their bytes apart, and what is given back is used again", "[io]") {
  const TempFolder temp;
  io::MappedMemory memory(temp.path());
  CHECK(memory.mapped_bytes() == 0);
  struct Block {
    unsigned char* at;
    std::size_t bytes;
    unsigned char value;
  };
  std::vector<Block> blocks;
  core::Rng rng(3);
  const auto add = [&] {
    const std::size_t bytes = 1 + rng.below(60'000);
    auto* const at = static_cast<unsigned char*>(memory.allocate(bytes, 64));
    const auto value = static_cast<unsigned char>(rng.below(256));
    std::memset(at, value, bytes);
    blocks.push_back({at, bytes, value});
  };
  const auto remove = [&](std::size_t k) {
    const Block block = blocks[k];
    bool whole = true;
    for (std::size_t i = 0; i < block.bytes; ++i) whole = whole && block.at[i] == block.value;
    CHECK(whole);
    memory.deallocate(block.at, block.bytes, 64);
    blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(k));
  };
  for (int k = 0; k < 100; ++k) add();
  for (int k = 0; k < 2000; ++k) {
    remove(rng.below(static_cast<std::uint32_t>(blocks.size())));
    add();
  }
  const std::size_t most = memory.mapped_bytes();
  CHECK(most < 4 * memory.used_bytes());
  while (!blocks.empty()) remove(blocks.size() - 1);
  CHECK(memory.used_bytes() == 0);
  // All of it is one run again.
  void* const half = memory.allocate(most / 2);
  CHECK(memory.mapped_bytes() == most);
  memory.deallocate(half, most / 2);
}

TEST_CASE("The file of mapped memory has no name", "[io]") {
  const TempFolder temp;
  io::MappedMemory memory(temp.path());
  void* const block = memory.allocate(10);
  CHECK(memory.mapped_bytes() >= 10);
  CHECK(std::filesystem::is_empty(temp.path()));
  memory.deallocate(block, 10);
}

TEST_CASE("Mapped memory that has no folder says so", "[io]") {
  const TempFolder temp;
  io::MappedMemory memory(temp / "missing");
  CHECK_THROWS_AS(memory.allocate(10), core::IoError);
}
