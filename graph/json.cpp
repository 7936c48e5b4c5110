// SPDX-License-Identifier: Apache-2.0
#include "graph/json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace emberfold::graph::detail {

namespace {
std::string whole(double value) {
  return std::to_string(static_cast<long long>(value));
}
}  // namespace

std::string complaint(const Patch& patch) {
  constexpr double kLargest = 1e6, kMostNats = 1e9;
  const auto check = [](const char* field, double value, double least, double most) -> std::string {
    if (value >= least && value <= most) return {};
    std::string result = "\"" + std::string(field) + "\" is ";
    if (std::isfinite(value)) {
      append(result, value);
    } else {
      result += "not finite";
    }
    return result + ", allowed is " + (least < 0 ? "-" + whole(most) : "0") + " to " + whole(most);
  };
  struct Field {
    const char* name;
    double value, least, most = kLargest;
  };
  const std::array<Field, 9> fields{{{"x", patch.position.x, -kLargest},
                                     {"y", patch.position.y, -kLargest},
                                     {"theta", patch.theta, -kLargest},
                                     {"width", patch.width, 0},
                                     {"blur", patch.blur, 0},
                                     {"hollow", patch.hollow, 0},
                                     {"contrast", patch.contrast, -kLargest},
                                     {"cost", patch.cost, 0, kMostNats},
                                     {"gain", patch.gain, -kMostNats, kMostNats}}};
  for (const Field& field : fields) {
    if (auto text = check(field.name, field.value, field.least, field.most); !text.empty()) return text;
  }
  if (patch.hollow > patch.width) {
    std::string text = "\"hollow\" is ";
    append(text, patch.hollow);
    text += ", allowed is 0 to \"width\", ";
    append(text, patch.width);
    return text;
  }
  for (const auto& [name, level] : {std::pair{"left", patch.left},
                                    {"middle", patch.middle},
                                    {"right", patch.right},
                                    {"between", patch.between}}) {
    for (const float value : level) {
      if (auto text = check(name, static_cast<double>(value), -kLargest, kLargest); !text.empty())
        return text;
    }
  }
  return {};
}

namespace {
template <class Number>
void append_shortest(std::string& text, Number value) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}
}  // namespace

void append(std::string& text, double value) {
  append_shortest(text, value);
  if (value == 0 && std::signbit(value)) text += ".0";  // "-0" would read back as the whole number 0
}

void append(std::string& text, float value) {
  append_shortest(text, value);
  if (value == 0 && std::signbit(value)) text += ".0";
}

void append(std::string& text, std::uint32_t value) {
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

nlohmann::json parse_shallow(std::string_view text) {
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

std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) result += (c >= ' ' && c <= '~' && c != '"') ? c : '?';
  return result + (text.size() > kLongest ? "…\"" : "\"");
}

}  // namespace emberfold::graph::detail
