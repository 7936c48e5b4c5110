// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/command_line.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <tuple>

#include "core/io/require_apart.hpp"

namespace emberfold::apps {

namespace {
template <class Whole>
void parse_whole(const std::string& option, const std::string& text, Whole& value, const char* allowed) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc{} || stop != end)
    throw CLI::ValidationError(option, "'" + text + "' is not a whole number" + allowed);
}
}  // namespace

std::string option_name(const std::string& field) {
  std::string name = "--" + field;
  std::ranges::replace(name, '_', '-');
  return name;
}

void parse_number(const std::string& option, const std::string& text, double& value) {
  char* stop = nullptr;
  value = std::strtod(text.c_str(), &stop);
  if (text.empty() || stop != text.c_str() + text.size())
    throw CLI::ValidationError(option, "'" + text + "' is not a number");
}

void parse_number(const std::string& option, const std::string& text, int& value) {
  parse_whole(option, text, value, " that fits");
}

void parse_number(const std::string& option, const std::string& text, std::uint64_t& value) {
  parse_whole(option, text, value, " from 0 to 18446744073709551615");
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

namespace {
bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}
}  // namespace

std::string without_struct_name(const std::string& message) {
  const auto end = static_cast<std::size_t>(std::ranges::find_if_not(message, is_word) - message.begin());
  for (const char* separator : {": ", "::", "."}) {
    const std::string_view rest = std::string_view(message).substr(end);
    if (end > 0 && rest.starts_with(separator))
      return std::string(rest.substr(std::string_view(separator).size()));
  }
  return message;
}

std::string with_option_name(const std::string& message, const std::string& field) {
  for (auto at = message.find(field); at != std::string::npos; at = message.find(field, at + 1)) {
    const auto end = at + field.size();
    if ((at > 0 && is_word(message[at - 1])) || (end < message.size() && is_word(message[end]))) continue;
    return message.substr(0, at) + option_name(field) + message.substr(end);
  }
  return message;
}

void add_common(CLI::App& command, CommonOptions& common, const std::string& json_about) {
  const char* group = "Everywhere";
  add_number(command, "--seed", common.seed, "N", "Seed of all that is random")->group(group);
  add_number(command, "--threads", common.threads, "N", "Most threads; 0: as many as the machine has")
      ->group(group);
  command.add_flag("--json", common.json, json_about)->group(group);
  command.add_flag("-q,--quiet", common.quiet, "Say nothing but warnings and errors")->group(group);
}

void add_reading(CLI::App& command, Reading& reading) {
  const char* group = "Reading the clip";
  command
      .add_option("CLIP", reading.clip,
                  "A video, a folder of images, a pattern (dir/img_*.png, dir/img_%04d.png), or "
                  "builtin:fire, builtin:cloth, builtin:river, builtin:rust")
      ->required()
      ->type_name("");
  command.add_option("--range", reading.range, "Frames a up to, not including, b; a: and :b are fine too")
      ->type_name("a:b")
      ->group(group);
  add_fields(command, reading.options, group);
  command.add_flag("--grey", reading.options.grey, "Read luma only")->group(group);
}

void add_output(CLI::App& command, std::string& folder) {
  command.add_option("-o,--output", folder, "Folder to write into; made where it is not there")
      ->type_name("DIR")
      ->required(folder.empty())
      ->default_str(folder);
}

void require_apart(const std::vector<std::string>& inputs, const std::string& folder,
                   const std::vector<std::string>& names) {
  std::vector<io::OutputPath> outputs{{folder, true}};
  for (const auto& name : names) outputs.push_back({std::filesystem::path(folder) / name});
  io::require_apart(inputs, outputs);
}

void check_common(const CommonOptions& common) {
  try {
    common.validate();
  } catch (const core::InputError& error) {
    throw Misuse("--" + std::string(error.what()));
  }
}

io::ReadOptions check_reading(const Reading& reading, const Session& session) {
  io::ReadOptions options = reading.options;
  options.seed = session.common.seed;
  try {
    if (!reading.range.empty()) std::tie(options.first, options.last) = io::parse_range(reading.range);
  } catch (const core::InputError& error) {
    throw Misuse("--range: " + std::string(error.what()));
  }
  check_options(options);
  return options;
}

}  // namespace emberfold::apps
