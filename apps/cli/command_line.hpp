// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/cli/command.hpp"
#include "apps/cli/option_fields.hpp"

// What the commands share in describing themselves to the parser. Only the commands' own sources include
// this.
namespace emberfold::apps {

/// "--min-contrast" of "min_contrast"
std::string option_name(const std::string& field);

/// Numbers of the whole text, else a CLI::ValidationError that names option and value.
void parse_number(const std::string& option, const std::string& text, double& value);
void parse_number(const std::string& option, const std::string& text, int& value);
void parse_number(const std::string& option, const std::string& text, std::uint64_t& value);

std::string number_text(double value);

/// The message without a leading "XxxOptions." or "xxx: ".
std::string without_struct_name(const std::string& message);
/// The message with the first mention of the field, as a whole word, replaced by its option's name.
std::string with_option_name(const std::string& message, const std::string& field);

template <class Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, Number& value, const std::string& unit,
                        const std::string& about) {
  return command
      .add_option_function<std::string>(
          name, [&value, name](const std::string& text) { parse_number(name, text, value); }, about)
      ->type_name(unit)
      ->default_str(number_text(static_cast<double>(value)));
}

/// One option for each field of an options struct; a switch for a bool: --no-… turns off what is on.
template <class Options>
void add_fields(CLI::App& command, Options& options, const std::string& group) {
  visit_fields(options,
               [&](const std::string& field, auto& value, const std::string& unit, const std::string& about) {
                 if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, bool>)
                   command
                       .add_flag_callback(
                           value ? "--no-" + option_name(field).substr(2) : option_name(field),
                           [&value, turned = !value] { value = turned; }, about)
                       ->group(group);
                 else
                   add_number(command, option_name(field), value, unit, about)->group(group);
               });
}

/// --seed, --threads, --json, --quiet.
void add_common(CLI::App& command, CommonOptions& common, const std::string& json_about);

struct Reading {
  std::string clip, range;
  io::ReadOptions options;
};
/// CLIP, --range, --scale, --grey.
void add_reading(CLI::App& command, Reading& reading);
/// -o DIR, required unless it has a default.
void add_output(CLI::App& command, std::string& folder);

/// Validates; what is wrong is told in the option's name, as Misuse.
template <class Options>
void check_options(Options& options) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    std::string message = without_struct_name(error.what());
    if constexpr (requires { visit_fields(options, [](auto&&...) {}); })
      visit_fields(options, [&](const std::string& field, auto&, auto&&...) {
        message = with_option_name(message, field);
      });
    throw Misuse(message);
  }
}
/// Refuses an output folder where the clip, mask … that is read lies at one of the names that are written.
void require_apart(const std::vector<std::string>& inputs, const std::string& folder,
                   const std::vector<std::string>& names);
void check_common(const CommonOptions& common);
/// Checks, and reads the range. The session's seed becomes that of a built-in clip.
io::ReadOptions check_reading(const Reading& reading, const Session& session);

}  // namespace emberfold::apps
