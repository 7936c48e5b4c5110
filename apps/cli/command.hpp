// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/cli/console.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/staged_output.hpp"
#include "core/stage_clock.hpp"

namespace CLI {
class App;
}

// main.cpp lets each command describe itself to the parser by add_…(). The parser then sets CommandLine::run.
namespace emberfold::apps {

/// An invalid command line; the program exits with 2.
class Misuse : public core::InputError {
 public:
  using core::InputError::InputError;
};

/// Options of every command.
struct CommonOptions {
  std::uint64_t seed = 1;
  int threads = 0;     ///< 0: all that the machine has; up to 1024
  bool json = false;   ///< print summary.json's content
  bool quiet = false;  ///< only warnings and errors, no progress and other messages
  ProgressForm progress = ProgressForm::text;
  bool overwrite = false;  ///< replace clips and files that are not earlier results
  void validate() const;
  [[nodiscard]] io::Existing existing() const { return overwrite ? io::Existing::all : io::Existing::own; }
};

/// Holds the outputs of a running command.
struct Session {
  Console& console;
  core::Context context;
  std::string command_line;
  CommonOptions common;
  std::vector<std::string> warnings = {};

  /// Throws core::Cancelled once the user has asked to stop.
  void check_stop() const;
  void warn(const std::string& text);
  /// Prints to standard output; core::IoError where that fails.
  void print(const std::string& text) const;
};

/// Measures the stages of a command for its summary.
struct Stages : core::StageClock {
  [[nodiscard]] nlohmann::ordered_json seconds() const;  ///< with "total"
};

class Settings;

/// The command that the command line names, with its options.
struct CommandLine {
  CommonOptions common;
  std::vector<std::string> words;  ///< as typed, without the program
  std::function<void(Session&)> run;
  std::map<std::string, std::shared_ptr<Settings>> settings;  ///< by command, "dytex learn"
};

void add_analyze(CLI::App& app, CommandLine& line);
void add_sketch(CLI::App& app, CommandLine& line);
void add_score(CLI::App& app, CommandLine& line);
void add_synthesis(CLI::App& app, CommandLine& line);
void add_motion(CLI::App& app, CommandLine& line);
void add_motion_likelihood(CLI::App& motion, CommandLine& line);
void add_morph(CLI::App& motion, CommandLine& line);
void add_demo(CLI::App& app, CommandLine& line);
void add_dytex(CLI::App& app, CommandLine& line);
void add_compare(CLI::App& app, CommandLine& line);
void add_quilt(CLI::App& app, CommandLine& line);
void add_runs(CLI::App& app, CommandLine& line);
void add_batch(CLI::App& runs, CommandLine& line);
void add_gather(CLI::App& runs, CommandLine& line);
void add_bench_events(CLI::App& runs, CommandLine& line);
void add_export(CLI::App& app, CommandLine& line);

/// Returns the peak memory of the process, MB.
double peak_memory_mb();

extern const char* const kVersion;

}  // namespace emberfold::apps
