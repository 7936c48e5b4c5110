// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/cli/command.hpp"
#include "apps/cli/settings.hpp"
#include "core/io/read_options.hpp"
#include "core/text/format_number.hpp"
#include "sketch/extract.hpp"

// Shared by the commands, which describe themselves to the parser. Only their own sources include this.
namespace emberfold::apps {

/// Returns "--min-contrast" for "min_contrast".
std::string option_name(const std::string& field);

/// Removes a leading "XxxOptions." or "xxx: " from a message.
std::string without_struct_name(const std::string& message);
/// Replaces the first mention of the field, as a whole word, by another name; by that of its option.
std::string with_name(const std::string& message, const std::string& field, const std::string& name);
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

/// Groups of options that --help summarises in a line; 'emberfold help reading' and 'help common' list them.
inline constexpr const char* kReadingGroup = "Reading";
inline constexpr const char* kCommonGroup = "Common";

/// Returns "emberfold dytex learn".
std::string full_name(const CLI::App* app);

/// Adds a command. Its examples, one per line after a line break, end its help.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& about,
                      const std::string& examples);

/// Adds --seed, --threads, --json and --quiet.
void add_common(CLI::App& command, CommonOptions& common);

/// Adds the common options, and makes the parser run `run(*asked, session)`. `note` is called before that, to
/// record the given options.
template <class Asked, class Run>
void finish_command(CLI::App& command, CommandLine& line, const std::shared_ptr<Asked>& asked, Run run,
                    const std::function<void()>& note = {}) {
  add_common(command, line.common);
  command.callback([asked, run, note, &line] {
    if (note) note();
    line.run = [asked, run](Session& session) { run(*asked, session); };
  });
}

/// Adds --set; the caller adds the settings to the result.
std::shared_ptr<Settings> add_settings(CLI::App& command, CommandLine& line);

/// Adds --sensitivity and --no-edges, which are often needed, and the other fields to the settings.
void add_sketch_options(CLI::App& command, Settings& settings, sketch::ExtractOptions& options);

/// Input options that are texts to parse; empty where not given.
struct ReadingWords {
  std::string range, region, fps, pixel_size, levels, channel, slice, stabilize, origin;
};
struct Reading {
  std::string clip;
  ReadingWords words;
  io::ReadOptions options;
  /// Returns whether every frame is used as stored, in colour or as grey.
  [[nodiscard]] bool is_whole() const;
};
/// Adds CLIP and the input options (--range, --roi, --scale …), or the latter alone. `with_mask`: adds
/// --mask, for commands without a mask of their own.
void add_reading(CLI::App& command, Reading& reading, bool with_mask = true);
void add_reading_options(CLI::App& command, ReadingWords& words, io::ReadOptions& options,
                         bool with_mask = true);
/// Adds -o DIR, required unless `folder` has a default.
void add_output(CLI::App& command, std::string& folder);

/// Adds -o OUT, required: a clip, or a folder of images.
void add_clip_output(
    CLI::App& command, std::string& clip,
    const std::string& about = "Write this clip: .mp4, .avi (lossless), a folder of PNG, or DIR/%05d.exr");

/// Throws Misuse with a message of validate() in which a field has its name in --set ("sketch.min_contrast"),
/// or its own option's name if it has one (`group` is empty, or frames, sensitivity).
[[noreturn]] void misuse(std::string message, const std::vector<std::string>& fields,
                         const std::string& group);
/// Validates options; throws Misuse.
template <class Options>
void check_options(const Options& options, const std::string& group) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    std::vector<std::string> fields;
    for (const auto& field : Options::fields()) fields.emplace_back(field.name);
    misuse(error.what(), fields, group);
  }
}
/// Throws io::OverwriteError where the folder, or a file of these names in it, is an input, or exists and is
/// no earlier result.
void require_apart(const std::vector<std::string>& inputs, const std::string& folder,
                   const std::vector<std::string>& names, const CommonOptions& common);
/// Throws io::OverwriteError where one of these files or folders of frames exists. Empty names are skipped.
void require_new(const std::vector<std::string>& paths, const CommonOptions& common);
void check_common(const CommonOptions& common);
/// Parses and checks the options. The session's seed becomes that of a built-in clip.
io::ReadOptions check_reading(const Reading& reading, const Session& session);
io::ReadOptions check_reading(const ReadingWords& words, io::ReadOptions options, const Session& session);

}  // namespace emberfold::apps
