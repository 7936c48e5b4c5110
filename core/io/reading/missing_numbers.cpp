// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/missing_numbers.hpp"

#include <charconv>
#include <cstdint>
#include <map>
#include <optional>

namespace emberfold::io {

namespace {

struct NumberedName {
  std::string head, tail;  ///< before and after the number
  std::int64_t number = 0;
};

std::optional<NumberedName> numbered(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  const auto dot = name.rfind('.');
  const auto end = name.find_last_of(kDigits, dot);
  if (end == std::string::npos) return std::nullopt;
  const auto before = name.find_last_not_of(kDigits, end);
  const auto begin = before == std::string::npos ? 0 : before + 1;
  NumberedName found{name.substr(0, begin), name.substr(end + 1), 0};
  const auto [stop, error] = std::from_chars(name.data() + begin, name.data() + end + 1, found.number);
  return error == std::errc() ? std::optional(found) : std::nullopt;
}

}  // namespace

std::string missing_numbers(const std::vector<std::filesystem::path>& files) {
  std::vector<NumberedName> names;
  for (const auto& file : files) {
    const auto name = numbered(file.filename().string());
    if (!name || (!names.empty() && (name->head != names.front().head || name->tail != names.front().tail)))
      return {};
    names.push_back(*name);
  }
  std::map<std::int64_t, std::size_t> steps;
  for (std::size_t i = 1; i < names.size(); ++i) ++steps[names[i].number - names[i - 1].number];
  std::int64_t usual = 0;
  for (const auto& [step, count] : steps)
    if (step > 0 && (usual == 0 || count > steps[usual])) usual = step;
  std::size_t gaps = 0, first = 0;
  std::int64_t missing = 0;
  for (std::size_t i = 1; usual > 0 && i < names.size(); ++i) {
    const std::int64_t step = names[i].number - names[i - 1].number;
    if (step <= usual) continue;
    if (gaps++ == 0) first = i;
    missing += (step - 1) / usual;
  }
  if (gaps == 0) return {};
  return files.front().parent_path().string() + ": " + std::to_string(missing) +
         (missing == 1 ? " number is" : " numbers are") +
         " missing in the names of the images, the first between " + files[first - 1].filename().string() +
         " and " + files[first].filename().string() + "; the images are taken as evenly spaced in time";
}

}  // namespace emberfold::io
