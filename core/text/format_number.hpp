// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::core {

/// Returns the shortest decimal text that reads back to the same number, "not finite" for what is none.
std::string number_text(double value);

/// Returns the number with `digits` decimals, as printf's %.*f.
std::string fixed_text(double value, int digits);

/// Returns the number with `digits` significant digits, as printf's %.*g.
std::string significant_text(double value, int digits);

/// Rounds to `digits` (0 to 15) decimals, halves away from zero.
double round_to(double value, int digits);

/// Rounds a finite number to `digits` (1 to 17) significant decimal digits.
double round_significant(double value, int digits);

}  // namespace emberfold::core
