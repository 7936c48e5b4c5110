// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace emberfold::core {

/// Appends a number in the shortest form that reads back the same, and as JSON knows it. Finite.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
void append_number(std::string& text, std::uint32_t value);

/// Reads a line of at most `limit` bytes; nullopt at the end of the stream. `ended`: whether a line break
/// stood behind it. IoError (no prefix) where the line is longer.
struct TextLine {
  std::string text;
  bool ended = false;
};
std::optional<TextLine> read_line(std::istream& in, std::size_t limit);

/// Parses one JSON value nested at most 16 deep. IoError (no prefix) tells where it is none.
nlohmann::json parse_json(std::string_view text);

/// A text from outside as it may stand in a message: short, printable, on one line.
std::string quoted(std::string_view text);

}  // namespace emberfold::core
