// SPDX-License-Identifier: Apache-2.0
// The heads, axes and pages of a TIFF stack, which is read from a file.
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "core/io/tiff/axes.hpp"
#include "core/io/tiff/page_reader.hpp"
#include "core/io/tiff_pages.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

namespace {

constexpr std::uint64_t kMostPixels = 1 << 16;  // a page larger than that is another target's matter

struct TemporaryFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("emberfold_fuzz_" + std::to_string(::getpid()) + ".tif");
  TemporaryFile() = default;
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

void check_page(const std::filesystem::path& path, const io::TiffPage& page) {
  if (page.width > kMostPixels || page.height > kMostPixels || page.width * page.height > kMostPixels) return;
  const cv::Mat read = io::PageReader(path).read(page);
  if (read.total() != page.width * page.height) fuzz::broken("a page of another size than its head says");
}

void check_axes(const io::TiffAxes& axes, std::size_t pages) {
  const auto planes = static_cast<std::size_t>(axes.frames) * static_cast<std::size_t>(axes.slices) *
                      static_cast<std::size_t>(axes.channels);
  if (axes.planes.size() != planes) fuzz::broken("axes that do not tell the page of every plane");
  for (const int plane : axes.planes)
    if (plane < 0 || static_cast<std::size_t>(plane) >= pages)
      fuzz::broken("a plane on a page that is not there");
  for (const std::string& doubt : axes.doubts) fuzz::check_message(doubt, "");
}

}  // namespace

FUZZ_TARGET(tiff)(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFile file;
  std::ofstream(file.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const auto check_warning = [](const std::string& text) { fuzz::check_message(text, ""); };
    const std::vector<io::TiffPage> pages = io::read_picture_pages(file.path, check_warning);
    if (pages.empty()) fuzz::broken("a stack without pages");
    check_axes(io::read_tiff_axes(file.path, pages), pages.size());
    check_page(file.path, pages.front());
    check_page(file.path, pages.back());
  } catch (const core::IoError& error) {
    fuzz::check_message(error.what(), "");
    if (std::string(error.what()).find(file.path.string()) == std::string::npos)
      fuzz::broken("a message without the file: " + std::string(error.what()));
  }
  return 0;
}
