// SPDX-License-Identifier: Apache-2.0
#include "core/text/format_number.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/text/json_reader.hpp"

namespace emberfold::core {

std::string number_text(double value) {
  if (!std::isfinite(value)) return "not finite";
  std::string text;
  append_number(text, value);
  return text;
}

std::string fixed_text(double value, int digits) {
  std::array<char, 400> text{};  // the largest double has 309 digits before the point
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string significant_text(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

double round_to(double value, int digits) {
  double unit = 1;
  for (int i = 0; i < digits; ++i) unit *= 10;
  return std::round(value * unit) / unit;
}

double round_significant(double value, int digits) {
  return std::strtod(significant_text(value, digits).c_str(), nullptr);
}

}  // namespace emberfold::core
