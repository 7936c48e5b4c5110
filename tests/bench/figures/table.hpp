// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace emberfold::figures {

enum class Sense { at_most, at_least };

/// Holds the bound that a figure must meet.
struct Target {
  Sense sense;
  double value;
  [[nodiscard]] bool met(double figure) const {
    return sense == Sense::at_most ? figure <= value : figure >= value;
  }
};

inline Target at_most(double value) {
  return {Sense::at_most, value};
}
inline Target at_least(double value) {
  return {Sense::at_least, value};
}

/// One line of the table. A figure that is not a number meets no target.
struct Row {
  std::string what;
  double figure;
  int digits;  ///< behind the point
  std::string unit;
  std::optional<Target> target;  ///< none: for information
};

/// measure | figure | target | met or not.
void print_heading(std::ostream& out);
void print(std::ostream& out, const std::vector<Row>& rows);
/// Prints the number of targets that are met.
void print_sum(std::ostream& out, const std::vector<Row>& rows);

}  // namespace emberfold::figures
