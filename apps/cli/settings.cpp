// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/settings.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <type_traits>

#include "apps/cli/command.hpp"
#include "apps/cli/did_you_mean.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

template <class Whole>
void parse_whole(const std::string& option, const std::string& text, Whole& value, const char* allowed) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc{} || stop != end)
    throw Misuse(option + ": '" + text + "' is not a whole number" + allowed);
}

std::string comma_list(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

}  // namespace

void parse_number(const std::string& option, const std::string& text, double& value) {
  char* stop = nullptr;
  value = std::strtod(text.c_str(), &stop);
  if (text.empty() || stop != text.c_str() + text.size())
    throw Misuse(option + ": '" + text + "' is not a number");
}

void parse_number(const std::string& option, const std::string& text, int& value) {
  parse_whole(option, text, value, " that fits");
}

void parse_number(const std::string& option, const std::string& text, std::uint64_t& value) {
  parse_whole(option, text, value, " from 0 to 18446744073709551615");
}

void parse_number(const std::string& option, const std::string& text, bool& value) {
  for (const auto& [yes, no] : {std::pair{"true", "false"}, {"on", "off"}, {"yes", "no"}, {"1", "0"}}) {
    if (text != yes && text != no) continue;
    value = text == yes;
    return;
  }
  throw Misuse(option + ": '" + text + "' is neither true nor false");
}

void Settings::add(const std::string& group, const std::string& field, NumberPointer value,
                   const std::string& unit, const std::string& about, const std::string& allowed) {
  std::visit(
      [&](auto* number) {
        constexpr bool is_switch = std::is_same_v<decltype(number), bool*>;
        const std::string initial = !is_switch ? number_text(static_cast<double>(*number))
                                    : *number  ? "true"
                                               : "false";
        settings_.push_back({group, field, initial, unit, about, is_switch ? "true, false" : allowed,
                             [number, name = group + "." + field](const std::string& text) {
                               parse_number("--set " + name, text, *number);
                             }});
      },
      value);
}

void Settings::add_word(const std::string& group, const std::string& field, std::string& value,
                        const std::vector<std::string>& words, const std::string& unit,
                        const std::string& about) {
  const auto assign = [&value, words, name = group + "." + field](const std::string& text) {
    if (!words.empty() && std::ranges::find(words, text) == words.end())
      throw Misuse("--set " + name + ": '" + text + "' is not known; allowed is " + comma_list(words) +
                   suggestion(text, words));
    value = text;
  };
  settings_.push_back({group, field, value, unit, about, comma_list(words), assign});
}

void Settings::assign(const std::string& assignment) {
  const auto equals = assignment.find('=');
  const std::string name = assignment.substr(0, equals);
  const auto dot = name.find('.');
  if (equals == std::string::npos || dot == std::string::npos)
    throw Misuse("--set is '" + one_line(assignment) + "'; expected is GROUP.FIELD=VALUE, such as " +
                 settings_.front().group + "." + settings_.front().field + "=" + settings_.front().initial);
  const std::string group = name.substr(0, dot), field = name.substr(dot + 1);
  const auto known_groups = groups(), known_fields = fields(group);
  if (known_fields.empty())
    throw Misuse("--set: there is no group '" + one_line(group) + "'; allowed is " +
                 comma_list(known_groups) + suggestion(group, known_groups));
  for (auto& setting : settings_) {
    if (setting.group != group || setting.field != field) continue;
    setting.assign(assignment.substr(equals + 1));
    setting.given = true;
    return;
  }
  throw Misuse("--set: " + group + " has no field '" + one_line(field) + "'; allowed is " +
               comma_list(known_fields) + suggestion(field, known_fields));
}

bool Settings::is_given(const std::string& name) const {
  return std::ranges::any_of(settings_,
                             [&](const Setting& s) { return s.given && s.group + "." + s.field == name; });
}

std::string Settings::name_of(const std::string& option) const {
  std::string field = option;
  std::ranges::replace(field, '-', '_');
  for (const auto& wanted : {field, field.starts_with("no_") ? field.substr(3) : field})
    for (const auto& setting : settings_)
      if (setting.field == wanted || setting.group + "_" + setting.field == wanted)
        return setting.group + "." + setting.field;
  return {};
}

std::vector<std::string> Settings::groups() const {
  std::vector<std::string> names;
  for (const auto& setting : settings_)
    if (std::ranges::find(names, setting.group) == names.end()) names.push_back(setting.group);
  return names;
}

std::vector<std::string> Settings::fields(const std::string& group) const {
  std::vector<std::string> names;
  for (const auto& setting : settings_)
    if (setting.group == group) names.push_back(setting.field);
  return names;
}

}  // namespace emberfold::apps
