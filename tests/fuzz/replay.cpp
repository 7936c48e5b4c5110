// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target once on every file of the folders given.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/fuzz/check.hpp"

int main(int argc, char** argv) {
  std::size_t files = 0;
  for (int i = 1; i < argc; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::ostringstream bytes;
      bytes << in.rdbuf();
      const std::string text = bytes.str();
      std::fprintf(stderr, "%s\n", entry.path().filename().c_str());
      LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
      ++files;
    }
  if (files == 0) std::fprintf(stderr, "no files\n");
  return files == 0 ? 1 : 0;
}
