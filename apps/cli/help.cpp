// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/help.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/cli/did_you_mean.hpp"

namespace emberfold::apps {

namespace {

using Row = std::vector<std::string>;

/// Returns the number of characters of a UTF-8 text.
std::size_t length(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Writes rows as aligned columns, two spaces in between; a cell wider than `widest` shifts its own row
/// alone.
std::string table(const std::vector<Row>& rows, std::size_t widest) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (widths.size() <= i) widths.push_back(0);
      if (length(row[i]) <= widest) widths[i] = std::max(widths[i], length(row[i]));
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += "  " + row[i];
      if (i + 1 < row.size() && length(row[i]) < widths[i])
        line += std::string(widths[i] - length(row[i]), ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::vector<const CLI::App*> subcommands(const CLI::App* app) {
  return app->get_subcommands([](const CLI::App*) { return true; });
}

std::string option_words(const CLI::Option* option) {
  if (option->get_positional()) return option->get_name(true);
  std::string text = option->get_name(false, true);
  if (const auto comma = text.find(','); comma != std::string::npos) text.insert(comma + 1, " ");
  if (option->get_type_size() != 0 || option->get_expected_max() > 0) {
    if (!option->get_type_name().empty() && option->get_items_expected_max() > 0)
      text += " " + option->get_type_name();
    if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
  }
  return text;
}

Row option_row(const CLI::Option* option) {
  return {option_words(option), option->get_description()};
}

bool is_own(const CLI::Option* option) {
  return !option->get_group().empty() && option->get_group() != kReadingGroup &&
         option->get_group() != kCommonGroup && option->get_single_name() != "help" &&
         option->get_single_name() != "version";
}

bool has_group(const CLI::App* app, const std::string& group) {
  return !app->get_options([&](const CLI::Option* option) { return option->get_group() == group; }).empty();
}

std::string short_name(const CLI::Option* option) {
  return option->get_snames().empty() ? "--" + option->get_lnames().front()
                                      : "-" + option->get_snames().front();
}

std::string usage(const CLI::App* app) {
  std::string text = "Usage: " + full_name(app);
  for (const auto* option : app->get_options())
    if (option->get_positional())
      text += option->get_required() ? " " + option->get_name(true) : " [" + option->get_name(true) + "]";
  for (const auto* option : app->get_options())
    if (!option->get_positional() && option->get_required())
      text += " " + short_name(option) + " " + option->get_type_name();
  if (!subcommands(app).empty()) text += " COMMAND";
  return text + " [options]\n";
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    std::string text = app->get_description() + "\n";
    if (const std::string examples = app->get_footer(); !examples.empty())
      text += "\nExamples:\n" + examples + "\n";
    text += "\n" + usage(app);
    std::vector<Row> rows;
    for (const auto* command : subcommands(app))
      if (command->get_name() != "help") rows.push_back({command->get_name(), command->get_description()});
    for (const auto* option : app->get_options())
      if (option->get_positional()) rows.push_back(option_row(option));
    for (const auto* option : app->get_options())
      if (!option->get_positional() && is_own(option) && !option->check_lname("set"))
        rows.push_back(option_row(option));
    if (const auto* set = app->get_option_no_throw("--set")) rows.push_back(option_row(set));
    if (app->get_parent() == nullptr) {
      rows.push_back(
          {"help TOPIC", "Print more: TOPIC is a command, 'reading', 'common' or 'options [COMMAND]'"});
      rows.push_back({"--version", "Print the version"});
    }
    text += table(rows, 30);
    if (has_group(app, kReadingGroup))
      text +=
          "  --range --every --roi --mask --scale --grey --fps --levels ...: see 'emberfold help reading'\n";
    if (has_group(app, kCommonGroup))
      text +=
          "  --seed N [1], --threads N [0], --json, --overwrite, -q, --quiet, -h: see 'emberfold help "
          "common'\n";
    return text;
  }
};

/// Describes the options of a group, from the first command that has them.
std::string group_help(const CLI::App& app, const std::string& group, const std::vector<Row>& more = {}) {
  std::vector<Row> rows;
  for (const auto* command : subcommands(&app)) {
    for (const auto* option : command->get_options())
      if (option->get_group() == group) rows.push_back(option_row(option));
    if (!rows.empty()) break;
  }
  rows.insert(rows.end(), more.begin(), more.end());
  return table(rows, 30);
}

std::string reading_help(const CLI::App& app) {
  return "Options of every command that reads a clip\n\n" + group_help(app, kReadingGroup) +
         "\nA clip (CLIP) is one of\n" +
         table(
             {{"clip.mp4", "a video: whatever FFmpeg decodes, 8 bits"},
              {"frames/", "a folder of images, one a frame, in natural order (img2 before img10)"},
              {"'dir/img_*.png'", "a pattern of images: * and ? in the last part of the name"},
              {"dir/img_%04d.png", "the same with a printf number"},
              {"stack.tif", "a TIFF: its pages are the frames; 8 bits, 16 bits or floats, grey or colour"},
              {"photo.png", "one image: a clip of one frame"},
              {"-, <(command)", "what comes through a pipe; it is kept in a temporary file while it is read"},
              {"builtin:fire",
               "a made clip: fire, cloth, river or rust; --seed chooses another of its kind"}},
             30) +
         "\nImages have 8 or 16 bits, TIFFs floats too. White is 255, or for 16 bits the largest number in "
         "as many\n"
         "bits as the brightest value needs; for floats 1 where no value is above 1, otherwise as for 16 "
         "bits.\n"
         "Where single pixels need two more bits than all others, these are left out; where values are "
         "negative,\n"
         "or use less than an eighth of the range, black and white are the ends of what they use; a note "
         "says "
         "so.\n"
         "Floats that are no numbers (NaN) are masked.\n"
         "Channels, slices, pixel size and frame interval of a stack are those that ImageJ or OME tell of.\n";
}

std::string common_help(const CLI::App& app) {
  return "Options of every command\n\n" +
         group_help(app, kCommonGroup, {{"-h, --help", "Print the help of the command"}}) +
         "\nThe same seed gives the same bytes with any number of threads. Results go to standard output,\n"
         "progress, warnings and errors to standard error.\n"
         "Exit status: 0 done, 1 failed, 2 misuse, 130 interrupted.\n";
}

std::string settings_help(const CLI::App& app, const CommandLine& line, const std::string& command) {
  // Commands in the order of the overview; a struct that several commands share is printed once.
  std::vector<std::string> names;
  for (const auto* one : subcommands(&app)) {
    names.push_back(one->get_name());
    for (const auto* inner : subcommands(one)) names.push_back(one->get_name() + " " + inner->get_name());
  }
  std::vector<std::pair<Settings::Setting, std::vector<std::string>>> found;
  for (const auto& name : names) {
    if (!line.settings.contains(name) || (!command.empty() && name != command)) continue;
    for (const auto& setting : line.settings.at(name)->all()) {
      const auto known = std::ranges::find_if(found, [&](const auto& other) {
        return other.first.group == setting.group && other.first.field == setting.field;
      });
      if (known == found.end())
        found.push_back({setting, {name}});
      else
        known->second.push_back(name);
    }
  }
  if (found.empty())
    throw Misuse("'" + command + "' has no options for --set; see 'emberfold help " + command + "'");
  std::vector<Row> rows{{"GROUP.FIELD", "DEFAULT", "UNIT", "ALLOWED", "MEANING"}};
  std::map<std::string, std::vector<std::string>> users;
  std::vector<std::string> groups;
  for (const auto& [setting, where] : found) {
    if (users[setting.group].empty()) groups.push_back(setting.group);
    for (const auto& name : where)
      if (std::ranges::find(users[setting.group], name) == users[setting.group].end())
        users[setting.group].push_back(name);
    rows.push_back({setting.group + "." + setting.field, setting.initial.empty() ? "-" : setting.initial,
                    setting.unit.empty() ? "-" : setting.unit,
                    setting.allowed.empty() ? "-" : setting.allowed, setting.about});
  }
  std::string text = "Options for --set GROUP.FIELD=VALUE" + (command.empty() ? "" : " of " + command) +
                     "\n\n" + table(rows, 34);
  if (!command.empty()) return text;
  text += "\nGroups and their commands\n";
  std::vector<Row> list;
  for (const auto& group : groups) {
    std::string where;
    for (const auto& name : users[group]) where += (where.empty() ? "" : ", ") + name;
    list.push_back({group, where});
  }
  return text + table(list, 30);
}

std::string joined_words(const std::vector<std::string>& words, std::size_t begin) {
  std::string text;
  for (std::size_t i = begin; i < words.size(); ++i) text += (text.empty() ? "" : " ") + words[i];
  return text;
}

std::string topic_help(const CLI::App& app, const CommandLine& line, const std::vector<std::string>& words) {
  // App::help() would print the help of the named subcommand, which is this one.
  if (words.empty()) return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  if (words[0] == "reading" && words.size() == 1) return reading_help(app);
  if (words[0] == "common" && words.size() == 1) return common_help(app);
  const bool options = words[0] == "options";
  const CLI::App* command = &app;
  for (std::size_t i = options ? 1 : 0; i < words.size(); ++i) {
    std::vector<std::string> known;
    if (command == &app && !options) known = {"common", "options", "reading"};
    const CLI::App* next = nullptr;
    for (const auto* one : subcommands(command)) {
      known.push_back(one->get_name());
      if (one->get_name() == words[i]) next = one;
    }
    if (next == nullptr) {
      const std::string nearest = nearest_word(words[i], known);
      throw Misuse("there is no help on '" + one_line(joined_words(words, 0)) + "'" +
                   (nearest.empty() ? "; see 'emberfold help'" : "; did you mean " + nearest + "?"));
    }
    command = next;
  }
  return options ? settings_help(app, line, joined_words(words, 1)) : command->help();
}

/// Returns the named command, down to the last subcommand.
const CLI::App& named_command(const CLI::App& app) {
  const auto named = app.get_subcommands();
  return named.empty() ? app : named_command(*named.front());
}

std::string unknown_option(const CLI::App& where, const CommandLine& line, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::string full = full_name(&where);
  const auto settings = line.settings.find(full.substr(full.find(' ') + 1));
  if (settings != line.settings.end() && name.starts_with("--"))
    if (const std::string field = settings->second->name_of(name.substr(2)); !field.empty())
      return "unknown option " + word + "; give it as --set " + field + "=" +
             (name.starts_with("--no-") ? "false" : "VALUE");
  std::vector<std::string> known;
  for (const auto* option : where.get_options())
    for (const auto& one : option->get_lnames()) known.push_back("--" + one);
  if (settings != line.settings.end())
    for (const auto& setting : settings->second->all()) known.push_back(option_name(setting.field));
  std::string nearest = nearest_word(name, known);
  if (settings != line.settings.end() && where.get_option_no_throw(nearest) == nullptr && !nearest.empty())
    nearest = "--set " + settings->second->name_of(nearest.substr(2)) + "=VALUE";
  return "unknown option " + word + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

/// Describes an option that took the next option's name as its value; empty where there is none.
std::string swallowed_option(const CLI::App& where) {
  for (const auto* option : where.get_options())
    for (const auto& value : option->results())
      if (value.starts_with("--") && where.get_option_no_throw(value) != nullptr)
        return option->get_name() + " needs a value (" + option->get_type_name() + "), but " + value +
               " follows it";
  return "";
}

}  // namespace

void set_help_format(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
}

void add_help(CLI::App& app, CommandLine& line) {
  auto* command = app.add_subcommand("help", "Print help on a command or a topic");
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("TOPIC", *words, "A command, reading, common, or options [COMMAND]")->type_name("");
  command->callback([words, &app, &line] {
    line.run = [text = topic_help(app, line, *words)](Session& session) { session.print(text); };
  });
}

std::string usage_message(const CLI::App& app, const CommandLine& line, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return error.what();
  const CLI::App& where = named_command(app);
  if (std::string told = swallowed_option(where); !told.empty()) return told;
  const auto extras = where.remaining(true);
  const std::string word = extras.empty() ? "" : extras.front();
  if (word.starts_with("-")) return unknown_option(where, line, word);
  const auto commands = subcommands(&where);
  if (commands.empty()) return "one argument too many: " + word;
  std::vector<std::string> known;
  for (const auto* command : commands) known.push_back(command->get_name());
  const std::string nearest = nearest_word(word, known);
  return "unknown command " + word + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

}  // namespace emberfold::apps
