// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/command.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "apps/cli/interrupt.hpp"

namespace emberfold::apps {

const char* const kVersion = EMBERFOLD_VERSION;

void CommonOptions::validate() const {
  if (threads < 0 || threads > 1024)
    throw core::InputError("threads is " + std::to_string(threads) + "; allowed is 0 (all) to 1024");
}

void Session::check_stop() const {
  if (context.cancelled()) throw core::Cancelled{};
}

void Session::warn(const std::string& text) {
  warnings.push_back(text);
  console.warn(text);
}

void Session::print(const std::string& text) const {
  errno = 0;
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!whole || std::fflush(stdout) != 0)
    throw core::IoError(std::string("cannot write to standard output: ") + std::strerror(errno));
}

nlohmann::ordered_json Stages::seconds() const {
  const auto rounded = [](double s) { return std::round(s * 1000) / 1000; };
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const auto& stage : ended()) out[stage.name] = rounded(stage.seconds);
  out["total"] = rounded(total());
  return out;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::round(static_cast<double>(usage.ru_maxrss) / 102.4) / 10;
}

}  // namespace emberfold::apps
