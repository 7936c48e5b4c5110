// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/console.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/text/format_number.hpp"

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

void Console::put_json(const std::string& kind, const std::string& text) {
  const nlohmann::ordered_json line = {{kind, text}};
  put(line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void Console::show(const RunProgress::State& state) {
  const auto percent = [](double share) { return std::to_string(static_cast<int>(std::floor(share * 100))); };
  if (form_ == ProgressForm::json) {
    nlohmann::ordered_json line = {{"stage", state.stage},
                                   {"number", state.number},
                                   {"of", state.of},
                                   {"share", core::round_to(state.share, 4)},
                                   {"whole", core::round_to(state.whole, 4)},
                                   {"seconds_left", nullptr}};
    if (state.seconds_left) line["seconds_left"] = core::round_to(*state.seconds_left, 1);
    put(line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    return;
  }
  std::string line = "\r" + one_line(state.stage);
  if (state.of > 0) line += " (" + std::to_string(state.number) + "/" + std::to_string(state.of) + ")";
  if (state.whole > 0) line += "  " + percent(state.whole) + " %";
  if (state.seconds_left) line += "  " + duration_text(*state.seconds_left) + " left";
  put(line + "\033[K");
  line_is_open_ = true;
}

void Console::progress(std::string_view stage, double fraction) {
  if (quiet_) return;
  const auto now = Clock::now();
  const auto since = [&](Clock::time_point time) {
    return std::chrono::duration<double>(now - time).count();
  };
  const bool is_new = stage != stage_;
  if (is_new) stage_ = stage, began_ = now;
  RunProgress::State state;
  if (plan_) state = plan_->report(stage, fraction, since(made_));
  if (form_ == ProgressForm::text && !terminal_) {
    if (is_new) put("emberfold: " + one_line(stage) + "\n");
    return;
  }
  constexpr auto kPause = std::chrono::milliseconds(100);
  if (!is_new && now - shown_ < kPause) return;
  shown_ = now;
  if (state.number == 0) {
    state.stage = stage, state.share = state.whole = fraction, state.of = 0;
    if (fraction > 0.01 && since(began_) > 1) state.seconds_left = since(began_) * (1 - fraction) / fraction;
  }
  show(state);
}

void Console::say(const std::string& text) {
  if (quiet_) return;
  if (form_ == ProgressForm::json) return put_json("message", text);
  clear_line();
  put(text + "\n");
}

void Console::warn(const std::string& text) {
  if (form_ == ProgressForm::json) return put_json("warning", one_line(text));
  clear_line();
  put("emberfold: warning: " + one_line(text) + "\n");
}

void Console::error(const std::string& text) {
  if (form_ == ProgressForm::json) return put_json("error", one_line(text));
  clear_line();
  put("emberfold: " + one_line(text) + "\n");
}

}  // namespace emberfold::apps
