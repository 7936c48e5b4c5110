// SPDX-License-Identifier: Apache-2.0
#include "core/io/read_options.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace emberfold::io {

namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& value, const std::string& allowed) {
  throw core::InputError(field + " " + value + " is out of range: " + allowed);
}

[[noreturn]] void refuse_text(const std::string& text, const std::string& expected) {
  throw core::InputError("\"" + text + "\" is no " + expected);
}

/// Formats a value as it was given, also one that is not a number.
std::string text_of(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

/// Reads a finite number that is the whole text.
std::optional<double> number(const std::string& text) {
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  const bool whole = !text.empty() && stop == text.c_str() + text.size() && std::isfinite(value);
  return whole ? std::optional(value) : std::nullopt;
}

std::vector<std::string> parts(const std::string& text, char separator) {
  std::vector<std::string> found(1);
  for (const char c : text)
    if (c == separator)
      found.emplace_back();
    else
      found.back() += c;
  return found;
}

}  // namespace

void ReadOptions::validate() const {
  if (first < 0)
    throw core::InputError("first frame " + std::to_string(first) + " is out of range: at least 0");
  if (last && *last <= first)
    throw core::InputError("the range " + std::to_string(first) + ":" + std::to_string(*last) +
                           " holds no frame; its end must lie behind its beginning");
  if (const auto field = fields()[0]; !field.range.holds(scale))
    refuse("scale", text_of(scale), field.range.text());
  if (channel && *channel < 0) refuse("channel", std::to_string(*channel), "at least 0");
  if (slice && *slice < 0) refuse("slice", std::to_string(*slice), "at least 0, or max");
  if (fps && !(*fps > 0 && *fps <= 1e6)) refuse("fps", text_of(*fps), "above 0, at most 1e6");
  if (pixel_size && !(*pixel_size > 0 && *pixel_size <= 1e9))
    refuse("pixel_size", text_of(*pixel_size) + " um", "above 0, at most 1 km");
  if (every < 1 || every > 1000000) refuse("every", std::to_string(every), "1 to 1000000");
  if (levels.kind == Levels::Kind::given &&
      !(levels.low < levels.high && std::isfinite(levels.high - levels.low)))
    refuse("levels", text_of(levels.low) + ":" + text_of(levels.high), "the first must be below the second");
  if (region && (region->x < 0 || region->y < 0 || region->width < 1 || region->height < 1))
    refuse("roi",
           std::to_string(region->x) + "," + std::to_string(region->y) + "," + std::to_string(region->width) +
               "," + std::to_string(region->height),
           "x and y from 0, width and height from 1");
}

ReadOptions ReadOptions::beside() const {
  ReadOptions other;
  other.first = first, other.last = last, other.every = every;
  other.region = region, other.scale = scale, other.grey = grey, other.seed = seed;
  other.fps = fps.value_or(25);
  other.levels.kind = Levels::Kind::stored;
  return other;
}

std::pair<std::int64_t, std::optional<std::int64_t>> parse_range(const std::string& text) {
  const auto refuse = [&]() -> std::int64_t {
    throw core::InputError(
        "\"" + text + "\" is no range of frames; give FIRST:END, FIRST: or :END (from 0, END not included)");
  };
  const auto number = [&](const char* begin, const char* end) {
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    return error != std::errc() || stop != end || value < 0 ? refuse() : value;
  };
  const auto colon = text.find(':');
  if (colon == std::string::npos || text.size() == 1) refuse();
  const char* const middle = text.data() + colon;
  const char* const end = text.data() + text.size();
  ReadOptions range;
  if (colon > 0) range.first = number(text.data(), middle);
  if (middle + 1 < end) range.last = number(middle + 1, end);
  range.validate();
  return {range.first, range.last};
}

Levels parse_levels(const std::string& text) {
  if (text == "auto") return {};
  if (text == "full") return {Levels::Kind::full};
  const auto ends = parts(text, ':');
  const auto low = number(ends.front()), high = number(ends.back());
  if (ends.size() != 2 || !low || !high) refuse_text(text, "range of values; give auto, full or LOW:HIGH");
  ReadOptions options;
  options.levels = {Levels::Kind::given, *low, *high};
  options.validate();
  return options.levels;
}

Region parse_region(const std::string& text) {
  const auto words = parts(text, ',');
  std::array<int, 4> values{};
  bool good = words.size() == values.size();
  for (std::size_t i = 0; good && i < values.size(); ++i) {
    const char* const end = words[i].data() + words[i].size();
    const auto [stop, error] = std::from_chars(words[i].data(), end, values[i]);
    good = error == std::errc() && stop == end;
  }
  if (!good) refuse_text(text, "region; give X,Y,WIDTH,HEIGHT in whole pixels");
  ReadOptions options;
  options.region = Region{values[0], values[1], values[2], values[3]};
  options.validate();
  return *options.region;
}

double parse_length(const std::string& text) {
  struct Unit {
    std::string_view name;
    double um;
  };
  // Both signs for micro that keyboards write.
  constexpr std::array<Unit, 7> kUnits{
      {{"nm", 1e-3}, {"um", 1}, {"\u00b5m", 1}, {"\u03bcm", 1}, {"mm", 1e3}, {"cm", 1e4}, {"m", 1e6}}};
  for (const Unit& unit : kUnits) {
    if (!text.ends_with(unit.name)) continue;
    std::string digits = text.substr(0, text.size() - unit.name.size());
    while (digits.ends_with(' ')) digits.pop_back();
    const auto value = number(digits);
    if (!value) continue;
    ReadOptions options;
    options.pixel_size = *value * unit.um;
    options.validate();
    return *options.pixel_size;
  }
  refuse_text(text, "length with a unit; give for instance 0.065um (nm, um, mm, cm or m)");
}

Stabilize parse_stabilize(const std::string& text) {
  for (const Stabilize one : {Stabilize::none, Stabilize::translation, Stabilize::similarity})
    if (text == name(one)) return one;
  refuse_text(text, "way to stabilize; give none, translation or similarity");
}

std::string name(Stabilize stabilize) {
  switch (stabilize) {
    case Stabilize::translation:
      return "translation";
    case Stabilize::similarity:
      return "similarity";
    default:
      return "none";
  }
}

}  // namespace emberfold::io
