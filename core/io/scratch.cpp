// SPDX-License-Identifier: Apache-2.0
#include "core/io/scratch.hpp"

#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <vector>

#include <unistd.h>

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kHead = ".emberfold-", kMark = ".part";

/// Returns the machine's name, letters and digits only.
const std::string& host() {
  static const std::string name = [] {
    std::array<char, 256> text{};
    ::gethostname(text.data(), text.size() - 1);
    std::string kept;
    for (const char* c = text.data(); *c != '\0'; ++c)
      if (std::isalnum(static_cast<unsigned char>(*c)) != 0) kept += *c;
    return kept.empty() ? std::string("host") : kept;
  }();
  return name;
}

/// True for ".emberfold-HOST-PID-N.part…" of this machine whose process has ended.
bool is_left_over(const std::string& name) {
  const std::string head = std::string(kHead) + host() + "-";
  if (!name.starts_with(head) || name.find(kMark, head.size()) == std::string::npos) return false;
  pid_t process = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + head.size(), end, process);
  if (error != std::errc() || stop == end || *stop != '-' || process <= 0) return false;
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

void remove_left_over(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (is_left_over(entry->path().filename().string())) found.push_back(entry->path());
  for (const auto& path : found) fs::remove_all(path, ignored);
}

}  // namespace

fs::path scratch_path(const fs::path& folder, const std::string& suffix) {
  static std::atomic<int> next{0};
  remove_left_over(folder.empty() ? fs::path(".") : folder);
  return folder / (std::string(kHead) + host() + "-" + std::to_string(::getpid()) + "-" +
                   std::to_string(++next) + std::string(kMark) + suffix);
}

}  // namespace emberfold::io
