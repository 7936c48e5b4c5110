// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <tuple>

#include "core/io/require_apart.hpp"

namespace emberfold::apps {

std::string option_name(const std::string& field) {
  std::string name = "--" + field;
  std::ranges::replace(name, '_', '-');
  return name;
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

std::string with_name(const std::string& message, const std::string& field, const std::string& name) {
  for (auto at = message.find(field); at != std::string::npos; at = message.find(field, at + 1)) {
    const auto end = at + field.size();
    if ((at > 0 && is_word(message[at - 1])) || (end < message.size() && is_word(message[end]))) continue;
    return message.substr(0, at) + name + message.substr(end);
  }
  return message;
}

std::string with_option_name(const std::string& message, const std::string& field) {
  return with_name(message, field, option_name(field));
}

void misuse(std::string message, const std::vector<std::string>& fields, const std::string& group) {
  message = without_struct_name(message);
  for (const auto& field : fields) {
    const bool is_option = group.empty() || field == "frames" || field == "sensitivity";
    std::string name = is_option ? option_name(field) : group;
    if (!is_option) name.append(".").append(field);
    message = with_name(message, field, name);
  }
  throw Misuse(message);
}

void add_sketch_options(CLI::App& command, Settings& settings, sketch::ExtractOptions& options) {
  add_number(command, "--sensitivity", options.sensitivity, "S",
             "Draw what is sure (0) up to all there may be (1)");
  command.add_flag_callback(
      "--no-edges", [&options] { options.edges = false; }, "Sketch ridges and valleys only, no step edges");
  settings.add("sketch", options, {"sensitivity", "edges", "tile"});
}

std::string full_name(const CLI::App* app) {
  const auto* parent = app->get_parent();
  return parent == nullptr ? app->get_name() : full_name(parent) + " " + app->get_name();
}

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& about,
                      const std::string& examples) {
  auto* command = parent.add_subcommand(name, about);
  command->footer(examples.substr(1));
  return command;
}

void add_common(CLI::App& command, CommonOptions& common) {
  add_number(command, "--seed", common.seed, "N", "Seed of all random numbers")->group(kCommonGroup);
  add_number(command, "--threads", common.threads, "N",
             "Use at most N threads; 0: as many as the machine has")
      ->group(kCommonGroup);
  command.add_flag("--json", common.json, "Print the results as JSON to standard output")
      ->group(kCommonGroup);
  command
      .add_flag("--overwrite", common.overwrite,
                "Replace clips and files that are there, also those that no emberfold command wrote")
      ->group(kCommonGroup);
  command
      .add_option_function<std::string>(
          "--progress",
          [&common](const std::string& form) {
            if (form != "text" && form != "json")
              throw Misuse("--progress is " + form + "; allowed is text or json");
            common.progress = form == "json" ? ProgressForm::json : ProgressForm::text;
          },
          "Tell progress and messages as text, or as a JSON object a line")
      ->type_name("text|json")
      ->default_str("text")
      ->group(kCommonGroup);
  command.add_flag("-q,--quiet", common.quiet, "Print nothing but warnings and errors")->group(kCommonGroup);
}

void add_reading(CLI::App& command, Reading& reading, bool with_mask) {
  command.add_option("CLIP", reading.clip, "Video, folder or pattern of images, TIFF stack, or builtin:NAME")
      ->required()
      ->type_name("");
  add_reading_options(command, reading.words, reading.options, with_mask);
}

void add_reading_options(CLI::App& command, ReadingWords& words, io::ReadOptions& options, bool with_mask) {
  const auto add_word = [&](const char* name, std::string& word, const char* unit, const char* about) {
    command.add_option(name, word, about)->type_name(unit)->group(kReadingGroup);
  };
  add_word("--range", words.range, "A:B", "Read frames A up to, not including, B; A: and :B are allowed");
  add_number(command, "--every", options.every, "N", "Read every N-th frame of these")->group(kReadingGroup);
  add_word("--roi", words.region, "X,Y,W,H", "Read this region alone, in pixels of the clip as stored");
  if (with_mask)
    add_word("--mask", options.mask, "FILE",
             "Structure counts where this image or clip of the stored size is not 0");
  add_word("--stabilize", words.stabilize, "HOW",
           "Take out the camera's motion: translation or similarity (and turning, zooming)");
  add_number(command, "--scale", options.scale, "FACTOR", "Resize the frames by this factor, above 0 to 16")
      ->group(kReadingGroup);
  command.add_flag("--grey", options.grey, "Read luma only")->group(kReadingGroup);
  add_word("--fps", words.fps, "F", "The frames were taken at this rate, whatever the file tells");
  add_word("--pixel-size", words.pixel_size, "LENGTH",
           "A stored pixel is as large as that: 0.065um (nm, um, mm, cm, m)");
  add_word("--origin", words.origin, "source|part",
           "Positions and times count from the source, or from the part that is read [source]");
  add_word("--levels", words.levels, "L",
           "Black and white: auto (bits or range in use), full (of the format) or LOW:HIGH");
  add_word("--channel", words.channel, "N",
           "Channel of a stack, from 0; of a clip in colour 0 red, 1 green, 2 blue");
  add_word("--slice", words.slice, "N|max", "Slice of a stack in depth, from 0; max: the brightest of all");
}

std::shared_ptr<Settings> add_settings(CLI::App& command, CommandLine& line) {
  auto settings = std::make_shared<Settings>();
  std::string name = full_name(&command);
  name.erase(0, name.find(' ') + 1);
  line.settings[name] = settings;
  // Kept whole: CLI11 must not split values at commas or brackets.
  command
      .add_option_function<std::string>(
          "--set", [settings](const std::string& text) { settings->assign(text); },
          "Set a rarer option; may repeat: 'emberfold help options " + name + "'")
      ->trigger_on_parse()
      ->type_name("GROUP.FIELD=VALUE");
  return settings;
}

void add_output(CLI::App& command, std::string& folder) {
  command.add_option("-o,--output", folder, "Write into this folder; it is made if missing")
      ->type_name("DIR")
      ->required(folder.empty())
      ->default_str(folder);
}

void add_clip_output(CLI::App& command, std::string& clip, const std::string& about) {
  command.add_option("-o,--output", clip, about)->type_name("OUT")->required();
}

void require_apart(const std::vector<std::string>& inputs, const std::string& folder,
                   const std::vector<std::string>& names, const CommonOptions& common) {
  std::vector<io::OutputPath> outputs{{folder, true}};
  for (const auto& name : names) outputs.push_back({std::filesystem::path(folder) / name});
  io::require_apart(inputs, outputs);
  if (!common.overwrite) io::require_own(folder, names);
}

void require_new(const std::vector<std::string>& paths, const CommonOptions& common) {
  namespace fs = std::filesystem;
  if (common.overwrite) return;
  for (const auto& path : paths) {
    std::error_code error;
    const auto replaced = io::replaced_path(path);
    const auto status = fs::status(replaced, error);
    const bool holds =
        fs::is_regular_file(status) || (fs::is_directory(status) && !fs::is_empty(replaced, error));
    if (!path.empty() && holds)
      throw io::OverwriteError("cannot write " + path + ": it is there already; --overwrite replaces it");
  }
}

void check_common(const CommonOptions& common) {
  try {
    common.validate();
  } catch (const core::InputError& error) {
    throw Misuse("--" + std::string(error.what()));
  }
}

bool Reading::is_whole() const {
  return words.range.empty() && words.region.empty() && words.channel.empty() && words.slice.empty() &&
         options.scale == 1 && options.every == 1;
}

namespace {

/// Parses the text of an option if given; Misuse names the option.
template <class Parse>
void parse_word(const char* option, const std::string& text, const Parse& parse) {
  if (text.empty()) return;
  try {
    parse();
  } catch (const Misuse&) {
    throw;
  } catch (const core::InputError& error) {
    throw Misuse(std::string(option) + ": " + error.what());
  }
}

}  // namespace

io::ReadOptions check_reading(const Reading& reading, const Session& session) {
  return check_reading(reading.words, reading.options, session);
}

io::ReadOptions check_reading(const ReadingWords& words, io::ReadOptions options, const Session& session) {
  options.seed = session.common.seed;
  parse_word("--range", words.range,
             [&] { std::tie(options.first, options.last) = io::parse_range(words.range); });
  parse_word("--roi", words.region, [&] { options.region = io::parse_region(words.region); });
  parse_word("--stabilize", words.stabilize,
             [&] { options.stabilize = io::parse_stabilize(words.stabilize); });
  if (!words.origin.empty() && words.origin != "source" && words.origin != "part")
    throw Misuse("--origin is " + one_line(words.origin) + "; allowed is source or part");
  options.counts_from_part = words.origin == "part";
  parse_word("--fps", words.fps, [&] { parse_number("--fps", words.fps, options.fps.emplace()); });
  parse_word("--pixel-size", words.pixel_size,
             [&] { options.pixel_size = io::parse_length(words.pixel_size); });
  parse_word("--levels", words.levels, [&] { options.levels = io::parse_levels(words.levels); });
  parse_word("--channel", words.channel,
             [&] { parse_number("--channel", words.channel, options.channel.emplace()); });
  parse_word("--slice", words.slice, [&] {
    if (words.slice == "max")
      options.brightest_slice = true;
    else
      parse_number("--slice", words.slice, options.slice.emplace());
  });
  try {
    options.validate();
  } catch (const core::InputError& error) {
    misuse(error.what(), {"scale", "fps", "every", "channel", "slice"}, "");
  }
  return options;
}

}  // namespace emberfold::apps
