// SPDX-License-Identifier: Apache-2.0
#include "core/text/format_number.hpp"

#include <cmath>

#include "core/text/json_reader.hpp"

namespace emberfold::core {

std::string number_text(double value) {
  if (!std::isfinite(value)) return "not finite";
  std::string text;
  append_number(text, value);
  return text;
}

}  // namespace emberfold::core
