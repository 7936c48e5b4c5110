// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <iostream>
#include <memory>
#include <new>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>

#include "apps/cli/command.hpp"
#include "apps/cli/did_you_mean.hpp"
#include "apps/cli/interrupt.hpp"
#include "core/io/require_apart.hpp"
#include "core/parallel.hpp"

namespace {

using namespace emberfold;

enum Exit { kDone = 0, kFailed = 1, kMisuse = 2, kInterrupted = 130 };

// "emberfold dytex learn"
std::string full_name(const CLI::App* app) {
  const auto* parent = app->get_parent();
  return parent == nullptr ? app->get_name() : full_name(parent) + " " + app->get_name();
}

// The command that was named, down to the last subcommand.
const CLI::App& named_command(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : named_command(*chosen.front());
}

// Help that opens with what a command is for and examples of it.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    label("OPTIONS", "options");
    label("SUBCOMMAND", "COMMAND");
    label("REQUIRED", "(required)");
    label("Positionals", "Arguments");
    column_width(32);
  }
  std::string make_description(const CLI::App* app) const override {
    const std::string examples = app->get_footer();
    return app->get_description() + "\n" + (examples.empty() ? "" : "\nExamples:\n" + examples + "\n") + "\n";
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    if (app->get_parent() != nullptr) name = full_name(app);
    return CLI::Formatter::make_usage(app, name);
  }
  std::string make_footer(const CLI::App*) const override { return {}; }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    for (auto at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n")) text.erase(at, 1);
    while (text.ends_with("\n\n")) text.pop_back();
    return text;
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (option->get_type_size() != 0) {
      if (!option->get_type_name().empty()) text += " " + option->get_type_name();
      if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
    }
    if (option->get_required() && !option->get_positional()) text += " " + get_label("REQUIRED");
    return text;
  }
};

std::string quoted(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:=,+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_line(int count, char** words) {
  std::string line = "emberfold";
  for (int i = 1; i < count; ++i) line += " " + quoted(words[i]);
  return line;
}

// One line that says what is wrong with the command line, and what may have been meant.
std::string misuse_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& where = named_command(app);
  const auto commands = where.get_subcommands([](const CLI::App*) { return true; });
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return error.what();
  const auto extras = where.remaining(true);
  const std::string word = extras.empty() ? "" : extras.front();
  std::vector<std::string> known;
  const bool is_option = word.starts_with("-");
  if (is_option) {
    for (const auto* option : where.get_options())
      for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  } else {
    for (const auto* command : commands) known.push_back(command->get_name());
  }
  const std::string what = is_option          ? "unknown option "
                           : commands.empty() ? "one argument too many: "
                                              : "unknown command ";
  const std::string nearest = apps::nearest_word(word.substr(0, word.find('=')), known);
  return what + word + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

// Frames are drawn in images that come and go by the dozen. Given back to the system each time, their pages
// cost a third of the time when they are touched again.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

int run(apps::Console& console, const apps::Chosen& chosen, const std::string& line) {
  const apps::InterruptWatch watch;
  apps::Session session{console, {}, line, chosen.common};
  session.context = core::Context(
      watch.token(), [&](std::string_view stage, double share) { console.progress(stage, share); },
      [&](const std::string& text) { session.warn(text); });
  try {
    chosen.common.validate();
  } catch (const core::InputError& error) {
    throw apps::Misuse("--" + std::string(error.what()));
  }
  const core::ThreadLimit limit(static_cast<std::size_t>(chosen.common.threads));
  chosen.run(session);
  return kDone;
}

int parse_and_run(int count, char** words, apps::Console& console) {
  CLI::App app(
      "emberfold follows moving textures (fire, cloth, water, smoke) as graphs of strokes,\n"
      "and finds where strokes are born, die, split, merge, connect and come apart.",
      "emberfold");
  app.footer(
      "  emberfold demo\n"
      "  emberfold analyze fire.mp4 -o out/fire\n"
      "  emberfold synth out/fire/model -o new_fire.mp4\n"
      "  emberfold dytex learn fire.mp4 -o out/fire_texture\n"
      "  emberfold compare fire.mp4 -o out/compare\n"
      "  emberfold quilt builtin:rust -o out/rust\n"
      "  emberfold sketch fire.mp4 -o out/sketch\n"
      "  emberfold score truth.json out/fire/events.json");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", std::string("emberfold ") + apps::kVersion, "Print the version");
  app.get_formatter()->label("SUBCOMMANDS", "COMMAND");
  app.require_subcommand(0, 1);
  apps::Chosen chosen;
  apps::add_analyze(app, chosen);
  apps::add_sketch(app, chosen);
  apps::add_score(app, chosen);
  apps::add_synthesis(app, chosen);
  apps::add_demo(app, chosen);
  apps::add_dytex(app, chosen);
  apps::add_compare(app, chosen);
  apps::add_quilt(app, chosen);
  for (auto* command : app.get_subcommands([](CLI::App*) { return true; })) command->group("Commands");
  try {
    app.parse(count, words);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    throw apps::Misuse(misuse_message(app, error));
  }
  if (!chosen.run) {
    std::cout << named_command(app).help() << std::flush;
    return kDone;
  }
  console.set_quiet(chosen.common.quiet);
  return run(console, chosen, command_line(count, words));
}

}  // namespace

int main(int count, char** words) {
  // Beyond a limit on file sizes a write shall fail, like on a full disk, not end the process.
  std::signal(SIGXFSZ, SIG_IGN);
  keep_freed_memory();
  apps::Console console;
  try {
    return parse_and_run(count, words, console);
  } catch (const core::Cancelled& interrupted) {
    console.error("interrupted; " + interrupted.kept);
    return kInterrupted;
  } catch (const apps::Misuse& error) {
    console.error(error.what());
    return kMisuse;
  } catch (const io::OverwriteError& error) {
    console.error(error.what());
    return kMisuse;
  } catch (const std::bad_alloc&) {
    console.error("out of memory");
    return kFailed;
  } catch (const std::exception& error) {
    console.error(error.what());
    return kFailed;
  }
}
