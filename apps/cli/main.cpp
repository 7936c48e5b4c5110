// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "apps/cli/command.hpp"
#include "apps/cli/help.hpp"
#include "apps/cli/interrupt.hpp"
#include "core/freed_memory.hpp"
#include "core/io/require_apart.hpp"
#include "core/parallel.hpp"

namespace {

using namespace emberfold;

enum Exit { kDone = 0, kFailed = 1, kMisuse = 2, kInterrupted = 130 };

std::string quoted(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:=,+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_line_text(int count, char** words) {
  std::string text = "emberfold";
  for (int i = 1; i < count; ++i) text += " " + quoted(words[i]);
  return text;
}

/// Puts the group before a command that had no group once ("batch" is "runs batch").
void name_group(std::vector<std::string>& words) {
  if (words.empty()) return;
  const std::string& name = words.front();
  if (name == "batch" || name == "gather" || name == "bench-events")
    words.insert(words.begin(), "runs");
  else if (name == "morph")
    words.insert(words.begin(), "motion");
}

int run(apps::Console& console, const apps::CommandLine& line, const std::string& text) {
  const apps::InterruptWatch watch;
  apps::Session session{console, {}, text, line.common};
  session.context = core::Context(
      watch.token(), [&](std::string_view stage, double share) { console.progress(stage, share); },
      [&](const std::string& warning) { session.warn(warning); });
  try {
    line.common.validate();
  } catch (const core::InputError& error) {
    throw apps::Misuse("--" + std::string(error.what()));
  }
  const core::ThreadLimit limit(static_cast<std::size_t>(line.common.threads));
  const auto out_of_memory = [&]() -> int {
    console.error("out of memory in '" + text + "'; --scale, --range and --threads 1 need less of it");
    return kFailed;
  };
  try {
    line.run(session);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) return out_of_memory();
    throw;
  }
  return kDone;
}

int parse_and_run(int count, char** words, apps::Console& console) {
  CLI::App app("Follow moving textures (fire, cloth, water, smoke) as graphs of strokes, and draw new ones.",
               "emberfold");
  app.footer(
      "  emberfold demo\n"
      "  emberfold analyze fire.mp4 -o out/fire\n"
      "  emberfold synth out/fire/model -o new_fire.mp4");
  apps::set_help_format(app);
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", std::string("emberfold ") + apps::kVersion, "Print the version");
  app.require_subcommand(0, 1);
  apps::CommandLine line;
  line.words.assign(words + 1, words + count);
  name_group(line.words);
  apps::add_analyze(app, line);
  apps::add_runs(app, line);
  apps::add_export(app, line);
  apps::add_synthesis(app, line);
  apps::add_motion(app, line);
  apps::add_sketch(app, line);
  apps::add_compare(app, line);
  apps::add_dytex(app, line);
  apps::add_quilt(app, line);
  apps::add_score(app, line);
  apps::add_demo(app, line);
  apps::add_help(app, line);
  try {
    app.parse(std::vector<std::string>(line.words.rbegin(), line.words.rend()));
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    throw apps::Misuse(apps::usage_message(app, line, error));
  }
  if (!line.run) {
    const CLI::App* named = &app;
    while (!named->get_subcommands().empty()) named = named->get_subcommands().front();
    std::cout << named->help() << std::flush;
    return kDone;
  }
  console.set_quiet(line.common.quiet);
  console.set_form(line.common.progress);
  return run(console, line, command_line_text(count, words));
}

}  // namespace

int main(int count, char** words) {
  // Above a limit on file sizes a write fails, as on a full disk, instead of ending the process.
  std::signal(SIGXFSZ, SIG_IGN);
  core::keep_freed_memory();
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
