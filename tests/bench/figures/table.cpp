// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/figures/table.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <ostream>

namespace emberfold::figures {

namespace {

constexpr int kNameWidth = 62;

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string line(const std::string& what, const std::string& figure, const std::string& target,
                 const std::string& met) {
  char text[256];
  std::snprintf(text, sizeof text, "%-*s | %12s | %9s | %s\n", kNameWidth, what.c_str(), figure.c_str(),
                target.c_str(), met.c_str());
  return text;
}

}  // namespace

void print_heading(std::ostream& out) {
  out << line("measure", "figure", "target", "") << std::string(kNameWidth, '-')
      << "-|--------------|-----------|--------\n";
}

void print(std::ostream& out, const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    std::string target, met;
    if (row.target) {
      target = (row.target->sense == Sense::at_most ? "<= " : ">= ") + number(row.target->value, 2);
      met = row.target->met(row.figure) ? "met" : "NOT MET";
    }
    out << line(row.what, number(row.figure, row.digits) + (row.unit.empty() ? "" : " " + row.unit), target,
                met);
  }
  out.flush();
}

void print_sum(std::ostream& out, const std::vector<Row>& rows) {
  const auto met =
      std::ranges::count_if(rows, [](const Row& r) { return r.target && r.target->met(r.figure); });
  const auto all = std::ranges::count_if(rows, [](const Row& r) { return r.target.has_value(); });
  out << met << " of " << all << " targets met" << std::endl;
}

}  // namespace emberfold::figures
