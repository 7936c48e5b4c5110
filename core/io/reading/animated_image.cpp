// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/animated_image.hpp"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace emberfold::io {

namespace {

using namespace std::string_view_literals;

std::string read_bytes(std::ifstream& in, std::size_t count) {
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  return in ? bytes : std::string();
}

std::uint32_t number(std::string_view bytes, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<std::uint8_t>(bytes[big_endian ? i : 3 - i]);
  return value;
}

/// The chunk acTL, which comes before the pixels, has the number of frames (PNG, third edition, 11.3.6.1).
Animation read_png(std::ifstream& in) {
  for (std::string head = read_bytes(in, 8); !head.empty(); head = read_bytes(in, 8)) {
    const std::string_view name = std::string_view(head).substr(4);
    if (name == "IDAT") break;
    if (name == "acTL")
      if (const std::string count = read_bytes(in, 4); !count.empty())
        return {Animation::Kind::apng, static_cast<int>(number(count, true) & 0x7FFFFFFFU)};
    in.seekg(std::streamoff{number(head, true)} + 4, std::ios::cur);
  }
  return {};
}

/// An animation has one chunk ANMF a frame (RFC 9649, 2.7.1).
Animation read_webp(std::ifstream& in) {
  Animation found{Animation::Kind::webp, 0};
  for (std::string head = read_bytes(in, 8); !head.empty(); head = read_bytes(in, 8)) {
    if (std::string_view(head).starts_with("ANMF")) ++found.frames;
    const std::streamoff size{number(std::string_view(head).substr(4), false)};
    in.seekg(size + size % 2, std::ios::cur);
  }
  return found.frames > 0 ? found : Animation();
}

}  // namespace

Animation read_animation(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string head = read_bytes(in, 8);
  if (head == "\x89PNG\r\n\x1A\n"sv) return read_png(in);
  if (head.starts_with("RIFF") && read_bytes(in, 4) == "WEBP") return read_webp(in);
  return {};
}

}  // namespace emberfold::io
