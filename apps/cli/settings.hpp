// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "apps/cli/option_fields.hpp"
#include "core/error.hpp"

namespace emberfold::apps {

/// Reads a number that is the whole text. Throws Misuse that names the option and the value.
void parse_number(const std::string& option, const std::string& text, double& value);
void parse_number(const std::string& option, const std::string& text, int& value);
void parse_number(const std::string& option, const std::string& text, std::uint64_t& value);
/// Reads true or false (also on, off, yes, no, 1, 0).
void parse_number(const std::string& option, const std::string& text, bool& value);

/// Writes the shortest text that reads back as the number.
std::string number_text(double value);
/// Writes a number, or true or false.
template <class Value>
std::string value_text(const Value& value) {
  if constexpr (std::is_same_v<Value, bool>)
    return value ? "true" : "false";
  else
    return number_text(static_cast<double>(value));
}

/// Returns what follows "allowed is" (must be, has to be) in a message that names the field; empty otherwise.
std::string allowed_in(const std::string& message, const std::string& field);

/// The fields of options structs that `--set GROUP.FIELD=VALUE` changes in one command.
class Settings {
 public:
  struct Setting {
    std::string group, field, initial, unit, about;
    std::function<void(const std::string&)> assign;
    std::function<std::string()> allowed;  ///< range of the value, found by asking the struct's validate()
    bool given = false;
  };

  /// Adds every field of the struct that option_fields.hpp visits. `options` must outlive this.
  template <class Options>
  void add(const std::string& group, Options& options) {
    visit_fields(options, [&](const std::string& field, auto& value, const std::string& unit,
                              const std::string& about) {
      add(group, field, value, unit, about, [field] { return allowed_values<Options>(field); });
    });
  }
  /// Adds one field; `value` must outlive this.
  template <class Value>
  void add(const std::string& group, const std::string& field, Value& value, const std::string& unit,
           const std::string& about, std::function<std::string()> allowed = {}) {
    settings_.push_back({group, field, value_text(value), unit, about,
                         [&value, name = group + "." + field](const std::string& text) {
                           parse_number("--set " + name, text, value);
                         },
                         std::move(allowed)});
  }
  /// Adds a field whose value is one of some words, or any text where there are none.
  void add_word(const std::string& group, const std::string& field, std::string& value,
                const std::vector<std::string>& words, const std::string& unit, const std::string& about);

  /// Takes "GROUP.FIELD=VALUE". Throws Misuse that says what is allowed, and what may have been meant.
  void assign(const std::string& assignment);
  [[nodiscard]] bool is_given(const std::string& name) const;
  [[nodiscard]] const std::vector<Setting>& all() const { return settings_; }
  /// Returns "match.sigma_across" of "sigma-across" or "no-sigma-across"; empty where no field is called so.
  [[nodiscard]] std::string name_of(const std::string& option) const;

 private:
  template <class Options>
  static std::string allowed_values(const std::string& field) {
    Options options;
    visit_fields(options, [&](const std::string& name, auto& value, auto&&...) {
      using Value = std::remove_reference_t<decltype(value)>;
      if (name != field) return;
      if constexpr (std::is_floating_point_v<Value>)
        value = std::numeric_limits<Value>::quiet_NaN();
      else if constexpr (!std::is_same_v<Value, bool>)
        value = std::numeric_limits<Value>::lowest();
    });
    try {
      options.validate();
    } catch (const core::InputError& error) {
      return allowed_in(error.what(), field);
    }
    return {};
  }
  [[nodiscard]] std::vector<std::string> groups() const;
  [[nodiscard]] std::vector<std::string> fields(const std::string& group) const;

  std::vector<Setting> settings_;
};

}  // namespace emberfold::apps
