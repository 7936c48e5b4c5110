// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/option_field.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

/// Parses the whole text as a number. Throws Misuse that names the option and the value.
void parse_number(const std::string& option, const std::string& text, double& value);
void parse_number(const std::string& option, const std::string& text, int& value);
void parse_number(const std::string& option, const std::string& text, std::uint64_t& value);
/// Parses true or false (also on, off, yes, no, 1, 0).
void parse_number(const std::string& option, const std::string& text, bool& value);

using core::number_text;
using NumberPointer = std::variant<double*, int*, bool*>;

/// The fields of options structs that `--set GROUP.FIELD=VALUE` can change in one command.
class Settings {
 public:
  struct Setting {
    std::string group, field, initial, unit, about, allowed;
    std::function<void(const std::string&)> assign;
    bool given = false;
  };

  /// Adds the fields of a struct of options (core/option_field.hpp) but for those named in `without`.
  /// `options` must outlive this.
  template <class Options>
  void add(const std::string& group, Options& options, std::initializer_list<std::string_view> without = {}) {
    for (const auto& field : Options::fields()) {
      if (std::ranges::find(without, field.name) != without.end()) continue;
      std::visit(
          [&](const auto member) {
            add(group, field.name, &(options.*member), field.unit, field.meaning, field.allowed());
          },
          field.member);
    }
  }
  /// Adds one field; what `value` points to must outlive this.
  void add(const std::string& group, const std::string& field, NumberPointer value, const std::string& unit,
           const std::string& about, const std::string& allowed = {});
  /// Adds a field whose value is one of the given words, or any text if there are none.
  void add_word(const std::string& group, const std::string& field, std::string& value,
                const std::vector<std::string>& words, const std::string& unit, const std::string& about);

  /// Assigns "GROUP.FIELD=VALUE". Throws Misuse with the allowed values and a suggestion.
  void assign(const std::string& assignment);
  [[nodiscard]] bool is_given(const std::string& name) const;
  [[nodiscard]] const std::vector<Setting>& all() const { return settings_; }
  /// Returns "sketch.colour" for "colour" or "no-colour"; empty where no field has that name.
  [[nodiscard]] std::string name_of(const std::string& option) const;

 private:
  [[nodiscard]] std::vector<std::string> groups() const;
  [[nodiscard]] std::vector<std::string> fields(const std::string& group) const;

  std::vector<Setting> settings_;
};

}  // namespace emberfold::apps
