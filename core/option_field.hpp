// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace emberfold::core {

/// Holds the numbers that an option takes: low ≤ value ≤ high, or low < value ≤ high. A NaN is never one,
/// infinity only where `high` is.
struct OptionRange {
  double low = 0, high = 1;
  bool above = false;          ///< low itself is not allowed
  const char* zero = nullptr;  ///< what 0 means, which is allowed then, too

  [[nodiscard]] bool holds(double value) const {
    if (zero != nullptr && value == 0) return true;
    return std::isfinite(value) && (above ? value > low : value >= low) && value <= high;
  }
  /// Returns "0 to 1", "at least 2", "above 0", "above 0, up to 1"; with a zero "…, or 0 for …".
  [[nodiscard]] std::string text() const;
};

/// The range of a switch.
inline constexpr OptionRange kOnOff{};
constexpr OptionRange between(double low, double high, const char* zero = nullptr) {
  return {low, high, false, zero};
}
constexpr OptionRange at_least(double low) {
  return {low, std::numeric_limits<double>::infinity(), false, nullptr};
}
constexpr OptionRange above(double low, double high = std::numeric_limits<double>::infinity()) {
  return {low, high, true, nullptr};
}

/// Describes one field of a struct of options. Checks, error messages, --set, its help, summaries and
/// Python's docstrings are generated from these.
template <class Options>
struct OptionField {
  const char* name = "";
  std::variant<double Options::*, int Options::*, bool Options::*> member;
  const char* unit = "";  ///< PX, LEVELS, N …; empty for a switch
  OptionRange range;
  const char* meaning = "";

  [[nodiscard]] bool is_switch() const { return std::holds_alternative<bool Options::*>(member); }
  [[nodiscard]] std::string allowed() const { return is_switch() ? "true, false" : range.text(); }
};

namespace detail {

/// Throws InputError "<field> is <value>; allowed is <range>".
[[noreturn]] void refuse_field(const std::string& field, double value, const OptionRange& range);

}  // namespace detail

/// Throws InputError "<owner>.<field> is <value>; allowed is <range>" for the first field outside its range.
template <class Options>
void check_fields(const std::string& owner, const Options& options) {
  for (const auto& field : Options::fields())
    std::visit(
        [&](const auto member) {
          const double value = static_cast<double>(options.*member);
          if (!field.is_switch() && !field.range.holds(value))
            detail::refuse_field(owner + "." + field.name, value, field.range);
        },
        field.member);
}

}  // namespace emberfold::core
