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

/// Appends a finite number as JSON, in the shortest form that reads back to the same bits.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
void append_number(std::string& text, std::uint32_t value);

/// A line of text, without its line break.
struct TextLine {
  std::string text;
  bool ended = false;  ///< whether it had a line break
};
/// Reads a line of at most `limit` bytes; nullopt at the end of the stream.
/// Throws IoError (without a prefix) for a longer line.
std::optional<TextLine> read_line(std::istream& in, std::size_t limit);

/// Parses one JSON value, nested at most 16 deep.
/// Throws IoError (without a prefix) that names the position of the error.
nlohmann::json parse_json(std::string_view text);

/// Quotes a text of a file for a message: short, printable, on one line.
std::string quoted(std::string_view text);

}  // namespace emberfold::core
