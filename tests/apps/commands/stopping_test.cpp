// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "core/io/writing/folder_lock.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("a hang-up ends a run as Ctrl-C does, unless nohup has it ignored") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {640, 480}, 12, 20);
  const auto out = temp / "out";
  CommandOptions options;
  options.interrupt_if = [&] { return fs::exists(out); };
  options.signal = SIGHUP;
  const std::vector<std::string> sketch{"sketch", clip, "-o", out.string(), "--threads", "1"};
  const auto stopped = run_command(sketch, options);
  INFO(stopped.err);
  CHECK(stopped.exit == 130);
  CHECK(contains(stopped.err, "interrupted"));
  CHECK_FALSE(fs::exists(out));
  std::signal(SIGHUP, SIG_IGN);  // the program inherits it
  const auto kept = run_command(sketch, options);
  std::signal(SIGHUP, SIG_DFL);
  INFO(kept.err);
  CHECK(kept.exit == 0);
}

TEST_CASE("a second run into a folder that is written to is refused in one line") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {64, 48}, 4, 3);
  const io::FolderLock first(temp.path());
  check_one_line({"sketch", clip, "-o", temp.path().string(), "-q"}, 1,
                 {"another emberfold is writing into", temp.path().string(), "another folder"});
}
