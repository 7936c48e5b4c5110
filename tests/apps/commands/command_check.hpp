// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <sstream>

#include "core/io/clip_writer.hpp"
#include "tests/apps/commands/run_command.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

namespace emberfold::test {

/// A folder of pictures of moving strokes.
inline std::string write_strokes(const std::filesystem::path& path, cv::Size size, int frames,
                                 int count = 6) {
  const auto strokes = made_strokes(count, size.width, size.height, frames);
  const auto writer = io::create_video(path, size, 25, true);
  for (int t = 0; t < frames; ++t) writer->write(made_picture(strokes, size.width, size.height, t));
  writer->finish();
  return path.string();
}

inline std::vector<std::string> joined(const std::vector<std::string>& first,
                                       const std::vector<std::string>& second,
                                       const std::vector<std::string>& third = {}) {
  std::vector<std::string> all;
  for (const auto* part : {&first, &second, &third})
    for (const auto& word : *part) all.push_back(word);
  return all;
}

/// What was told, without the warnings that images tell no frame rate.
inline std::string without_rate_warnings(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);)
    if (!contains(line, "its frame rate is not known")) rest += line + "\n";
  return rest;
}

/// Fails in a way that names every `what`, on one line, and leaves nothing at `output`.
inline void check_one_line(const std::vector<std::string>& arguments, int exit,
                           const std::vector<std::string>& what, const std::filesystem::path& output = {}) {
  const auto result = run_command(arguments);
  const std::string told = without_rate_warnings(result.err);
  INFO(result.err);
  CHECK(result.exit == exit);
  CHECK(told.starts_with("emberfold: "));
  CHECK(std::ranges::count(told, '\n') == 1);
  CHECK(result.out.empty());
  for (const auto& part : what) CHECK(contains(told, part));
  if (output.empty()) return;
  CHECK_FALSE(std::filesystem::exists(output));
  CHECK_FALSE(std::filesystem::exists(output.string() + ".part"));
}

/// Fails unless the help of a dytex command opens with examples.
inline void check_help(const std::string& command) {
  const auto help = run_command({"dytex", command, "--help"});
  CHECK(help.exit == 0);
  const auto examples = help.out.find("Examples:\n  emberfold dytex " + command);
  REQUIRE(examples != std::string::npos);
  CHECK(examples < help.out.find("Usage: emberfold dytex " + command));
}

}  // namespace emberfold::test
