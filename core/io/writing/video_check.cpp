// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/video_check.hpp"

#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>

namespace emberfold::io {

namespace {

using Head = std::array<std::uint8_t, 16>;

struct Part {
  std::string_view name;
  std::uint64_t size;  ///< in bytes, its head included
};

Part riff_chunk(const Head& head, std::string_view text) {
  const std::uint32_t size =
      head[4] | std::uint32_t{head[5]} << 8 | std::uint32_t{head[6]} << 16 | std::uint32_t{head[7]} << 24;
  return {text.substr(0, 4), std::uint64_t{8} + size + (size & 1U)};
}

Part mp4_box(const Head& head, std::string_view text) {
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | head[at + i];
    return value;
  };
  const std::uint64_t small = number(0, 4);
  return {text.substr(4, 4), small == 1 ? number(8, 8) : small};
}

}  // namespace

bool video_is_whole(const std::filesystem::path& path) {
  const bool mp4 = path.extension() == ".mp4";
  std::error_code error;
  const std::uint64_t length = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in || length == 0) return false;
  bool found = false;
  std::uint64_t at = 0;
  while (at < length) {
    Head head{};
    in.clear();
    in.seekg(static_cast<std::streamoff>(at));
    in.read(reinterpret_cast<char*>(head.data()), head.size());
    if (in.gcount() < 8) return false;
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    const Part part = mp4 ? mp4_box(head, text) : riff_chunk(head, text);
    if (part.size < 8 || part.size > length - at || (!mp4 && part.name != "RIFF")) return false;
    found = found || !mp4 || part.name == "moov";
    at += part.size;
  }
  return found;
}

}  // namespace emberfold::io
