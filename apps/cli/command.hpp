// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
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

namespace CLI {
class App;
}

// How the commands of `emberfold` hang together: main.cpp lets each command describe itself to the parser
// (add_…), which leaves in Chosen what is to be run.
namespace emberfold::apps {

/// The command line asks for something that cannot be: exit 2.
class Misuse : public core::InputError {
 public:
  using core::InputError::InputError;
};

/// What every command takes.
struct CommonOptions {
  std::uint64_t seed = 1;
  int threads = 0;     ///< 0: as many as the machine has; up to 1024
  bool json = false;   ///< print summary.json's content
  bool quiet = false;  ///< no progress and no messages but warnings and errors
  void validate() const;
};

/// A running command's surroundings.
struct Session {
  Console& console;
  core::Context context;
  std::string command_line;
  CommonOptions common;
  std::vector<std::string> warnings = {};

  /// Throws core::Cancelled once the user asked to stop.
  void check_stop() const;
  void warn(const std::string& text);
  /// Prints to standard output; core::IoError where that fails.
  void print(const std::string& text) const;
};

/// The seconds that the stages of a command took, in their order.
class Stages {
 public:
  /// Ends the stage before and begins the next one.
  void begin(std::string name);
  void end();
  [[nodiscard]] nlohmann::ordered_json seconds() const;  ///< with "total"

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<std::pair<std::string, double>> done_;
  std::string name_;
  Clock::time_point first_ = Clock::now(), began_ = first_;
};

class Settings;

/// What the command line asks for.
struct Chosen {
  CommonOptions common;
  std::function<void(Session&)> run;
  std::map<std::string, std::shared_ptr<Settings>> settings;  ///< by command, "dytex learn"
};

void add_analyze(CLI::App& app, Chosen& chosen);
void add_sketch(CLI::App& app, Chosen& chosen);
void add_score(CLI::App& app, Chosen& chosen);
void add_synthesis(CLI::App& app, Chosen& chosen);
void add_demo(CLI::App& app, Chosen& chosen);
void add_dytex(CLI::App& app, Chosen& chosen);
void add_compare(CLI::App& app, Chosen& chosen);
void add_quilt(CLI::App& app, Chosen& chosen);

/// Peak memory of the process, MB.
double peak_memory_mb();

extern const char* const kVersion;

}  // namespace emberfold::apps
