// SPDX-License-Identifier: Apache-2.0
#include "core/text/json_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace emberfold::core {

namespace {
template <class Number>
void append_shortest(std::string& text, Number value) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}
}  // namespace

void append_number(std::string& text, double value) {
  append_shortest(text, value);
  if (value == 0 && std::signbit(value)) text += ".0";  // "-0" would read back as the whole number 0
}

void append_number(std::string& text, float value) {
  append_shortest(text, value);
  if (value == 0 && std::signbit(value)) text += ".0";
}

void append_number(std::string& text, std::uint32_t value) {
  append_shortest(text, value);
}

std::optional<TextLine> read_line(std::istream& in, std::size_t limit) {
  TextLine line;
  std::array<char, 1 << 14> block;
  if (!in || in.peek() == std::istream::traits_type::eof()) return std::nullopt;
  for (;;) {
    in.getline(block.data(), block.size());
    const bool more = in.fail() && !in.bad() && !in.eof();  // the block is full
    if (more) in.clear();
    const bool whole = in.good() && !more;
    line.text.append(block.data(), static_cast<std::size_t>(in.gcount()) - (whole ? 1 : 0));
    if (line.text.size() > limit) throw core::IoError("longer than " + std::to_string(limit >> 10) + " KiB");
    if (more) continue;
    line.ended = whole;
    break;
  }
  if (!line.text.empty() && line.text.back() == '\r') line.text.pop_back();
  return line;
}

nlohmann::json parse_json(std::string_view text) {
  constexpr int kDeepest = 16;
  const auto shallow = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > kDeepest) throw core::IoError("nested more than " + std::to_string(kDeepest) + " deep");
    return true;
  };
  try {
    return nlohmann::json::parse(text.begin(), text.end(), shallow);
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view before =
        text.substr(0, std::min(error.byte, text.size()) - (error.byte > 0 ? 1 : 0));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t column = before.size() - (line > 1 ? before.rfind('\n') + 1 : 0) + 1;
    throw core::IoError("no valid JSON at " +
                        (line > 1 ? "line " + std::to_string(line) + ", " : std::string()) + "column " +
                        std::to_string(column));
  } catch (const nlohmann::json::exception&) {
    throw core::IoError("no valid JSON: a number out of range");
  }
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) result += (c >= ' ' && c <= '~' && c != '"') ? c : '?';
  return result + (text.size() > kLongest ? "…\"" : "\"");
}

}  // namespace emberfold::core
