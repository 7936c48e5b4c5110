// SPDX-License-Identifier: Apache-2.0
#include "core/option_field.hpp"

#include "core/error.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::core {

std::string OptionRange::text() const {
  const bool bounded = high < std::numeric_limits<double>::infinity();
  std::string all = above     ? "above " + number_text(low) + (bounded ? ", up to " + number_text(high) : "")
                    : bounded ? number_text(low) + " to " + number_text(high)
                              : "at least " + number_text(low);
  if (zero != nullptr) all += ", or 0 for " + std::string(zero);
  return all;
}

namespace detail {

void refuse_field(const std::string& field, double value, const OptionRange& range) {
  throw InputError(field + " is " + number_text(value) + "; allowed is " + range.text());
}

}  // namespace detail

}  // namespace emberfold::core
