// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/commands/analysis.hpp"

// The options of `analyze` and `batch`.
namespace emberfold::apps {

struct AskedAnalysis {
  Reading reading;
  AnalyzeOptions options;
  std::string quality = "normal";
};

/// Adds the options of an analysis except the input options.
void add_analysis_options(CLI::App& command, AskedAnalysis& asked, CommandLine& line);

/// Parses the input options and checks all others. Throws Misuse.
AnalyzeOptions check_analysis(const AskedAnalysis& asked, const Session& session);

}  // namespace emberfold::apps
