// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "apps/cli/command.hpp"

namespace emberfold::apps {

/// Makes the --help of every command fit on one screen: description, examples, usage, a line per option.
void set_help_format(CLI::App& app);

/// Adds `emberfold help [TOPIC]`. `app` and `chosen` must outlive the parsing.
void add_help(CLI::App& app, CommandLine& line);

/// Returns one line about a command line that cannot be parsed, with a suggestion.
std::string usage_message(const CLI::App& app, const CommandLine& line, const CLI::ParseError& error);

}  // namespace emberfold::apps
