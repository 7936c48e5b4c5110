// SPDX-License-Identifier: Apache-2.0
// Gives every file of CORPUS/READER to its reader once: replay CORPUS
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/fuzz/check.hpp"

namespace {

using Reader = int (*)(const std::uint8_t*, std::size_t);

std::size_t replay(const std::filesystem::path& folder, Reader reader) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    const std::string text = bytes.str();
    // Printed first: a reader that breaks its promise aborts.
    std::fprintf(stderr, "%s\n", entry.path().c_str());
    reader(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    ++files;
  }
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "replay: the folder of the corpus is missing\n");
    return 2;
  }
  const std::filesystem::path corpus = argv[1];
  for (const auto& [name, reader] : emberfold::fuzz::readers())
    if (!std::filesystem::is_directory(corpus / name) || replay(corpus / name, reader) == 0) {
      std::fprintf(stderr, "replay: there are no files for the reader %s\n", name.c_str());
      return 1;
    }
  for (const auto& folder : std::filesystem::directory_iterator(corpus))
    if (!emberfold::fuzz::readers().contains(folder.path().filename().string())) {
      std::fprintf(stderr, "replay: there is no reader for %s\n", folder.path().c_str());
      return 1;
    }
  return 0;
}
