// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/console.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <unistd.h>

namespace emberfold::apps {

namespace {
void put(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}
}  // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

Console::Console() {
  const char* kind = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) == 1 && (kind == nullptr || std::strcmp(kind, "dumb") != 0);
}

Console::~Console() {
  clear_line();
}

void Console::clear_line() {
  if (line_is_open_) put("\r\033[K");
  line_is_open_ = false;
}

void Console::progress(std::string_view stage, double fraction) {
  if (quiet_) return;
  const auto now = Clock::now();
  const bool is_new = stage != stage_;
  if (is_new) stage_ = stage, began_ = now;
  if (!terminal_) {
    if (is_new) put("emberfold: " + one_line(stage) + "\n");
    return;
  }
  constexpr auto kPause = std::chrono::milliseconds(100);
  if (!is_new && now - shown_ < kPause) return;
  shown_ = now;
  const double spent = std::chrono::duration<double>(now - began_).count();
  std::string line = "\r" + one_line(stage);
  if (fraction > 0) line += "  " + std::to_string(static_cast<int>(std::floor(fraction * 100))) + " %";
  if (fraction > 0.01 && spent > 1) line += "  " + duration_text(spent * (1 - fraction) / fraction) + " left";
  put(line + "\033[K");
  line_is_open_ = true;
}

void Console::say(const std::string& text) {
  if (quiet_) return;
  clear_line();
  put(text + "\n");
}

void Console::warn(const std::string& text) {
  clear_line();
  put("emberfold: warning: " + one_line(text) + "\n");
}

void Console::error(const std::string& text) {
  clear_line();
  put("emberfold: " + one_line(text) + "\n");
}

}  // namespace emberfold::apps
