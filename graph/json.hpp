// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// What a reader and a writer of patches agree on: coordinates and lengths within ±1e6, theta too, so that
/// they can be turned into whole pixels safely; no negative width or blur. Empty, or what is wrong.
std::string complaint(const Patch& patch);

/// Appends a number in the shortest form that reads back the same, and as JSON knows it. Finite.
void append(std::string& text, double value);
void append(std::string& text, float value);
void append(std::string& text, std::uint32_t value);

/// Reads a line of at most `limit` bytes; nullopt at the end of the stream. `ended`: whether a line break
/// stood behind it. IoError (no prefix) where the line is longer.
struct TextLine {
  std::string text;
  bool ended = false;
};
std::optional<TextLine> read_line(std::istream& in, std::size_t limit);

/// Parses one JSON value nested at most 16 deep. IoError (no prefix) tells where it is none.
nlohmann::json parse_shallow(std::string_view text);

/// A text from outside as it may stand in a message: short, printable, on one line.
std::string shown(std::string_view text);

}  // namespace emberfold::graph::detail
