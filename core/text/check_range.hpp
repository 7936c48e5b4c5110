// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::core {

/// Throws InputError "<field> is <value>; allowed is <low> to <high>" unless low ≤ value ≤ high. A NaN is
/// refused.
inline void check_range(std::string_view field, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(std::string(field) + " is " + number_text(value) + "; allowed is " + number_text(low) +
                   " to " + number_text(high));
}

/// Throws InputError "<field> is <value>; allowed is above <low>, up to <high>" unless low < value ≤ high.
inline void check_above(std::string_view field, double value, double low, double high) {
  if (value > low && value <= high) return;
  throw InputError(std::string(field) + " is " + number_text(value) + "; allowed is above " +
                   number_text(low) + ", up to " + number_text(high));
}

/// Throws InputError "<field> is <value>; allowed is at least <low>" unless the value is finite and ≥ low.
inline void check_at_least(std::string_view field, double value, double low) {
  if (std::isfinite(value) && value >= low) return;
  throw InputError(std::string(field) + " is " + number_text(value) + "; allowed is at least " +
                   number_text(low));
}

/// Throws InputError "<field> is <value>; allowed is above <low>" unless the value is finite and > low.
inline void check_above(std::string_view field, double value, double low) {
  if (std::isfinite(value) && value > low) return;
  throw InputError(std::string(field) + " is " + number_text(value) + "; allowed is above " +
                   number_text(low));
}

/// Throws InputError "<field> is <value>; allowed is odd, <low> to <high>" unless value is odd and in the
/// range.
inline void check_odd(std::string_view field, int value, int low, int high) {
  if (value >= low && value <= high && value % 2 != 0) return;
  throw InputError(std::string(field) + " is " + number_text(value) + "; allowed is odd, " +
                   number_text(low) + " to " + number_text(high));
}

}  // namespace emberfold::core
