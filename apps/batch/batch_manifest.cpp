// SPDX-License-Identifier: Apache-2.0
#include "apps/batch/batch_manifest.hpp"

#include <cerrno>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "apps/cli/summary.hpp"
#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kFormat = "emberfold.batch";
constexpr int kVersionOfFile = 1;

BatchEntry read_entry(const nlohmann::json& value) {
  BatchEntry entry;
  entry.run = value.at("run").get<std::string>();
  entry.clip = value.at("clip").get<std::string>();
  entry.state = value.at("state").get<std::string>();
  entry.key = value.at("key").get<std::string>();
  entry.seconds = value.at("seconds").get<double>();
  entry.exit = value.at("exit").get<int>();
  entry.message = value.at("message").get<std::string>();
  return entry;
}

}  // namespace

Json manifest_json(const std::vector<BatchEntry>& entries) {
  Json runs = Json::array();
  for (const auto& entry : entries)
    runs.push_back({{"run", entry.run},
                    {"clip", entry.clip},
                    {"state", entry.state},
                    {"key", entry.key},
                    {"seconds", entry.seconds},
                    {"exit", entry.exit},
                    {"message", entry.message}});
  return {{"format", kFormat}, {"version", kVersionOfFile}, {"runs", std::move(runs)}};
}

std::vector<BatchEntry> read_manifest(const fs::path& folder) {
  const fs::path path = folder / kBatchFile;
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  auto in = io::open_file(path);
  std::ostringstream text;
  text << in.rdbuf();
  try {
    const auto value = core::parse_json(text.str());
    if (value.at("format") != kFormat) throw core::IoError("it is of another format");
    if (value.at("version") != kVersionOfFile) throw core::IoError("it is of another version");
    std::vector<BatchEntry> entries;
    for (const auto& run : value.at("runs")) entries.push_back(read_entry(run));
    return entries;
  } catch (const nlohmann::json::exception&) {
    throw core::IoError(path.string() + " is no list of runs that emberfold runs batch wrote");
  } catch (const core::IoError& reason) {
    throw core::IoError(path.string() + ": " + reason.what());
  }
}

void write_manifest(const fs::path& folder, const std::vector<BatchEntry>& entries) {
  const io::StagedFile file(folder / kBatchFile);
  file.write([&](std::ostream& out) { out << json_text(manifest_json(entries)); });
  file.finish();
}

BatchLock::BatchLock(const fs::path& folder) {
  const fs::path path = folder / ".batch.lock";
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw core::IoError("cannot write " + path.string() + ": " + std::generic_category().message(errno));
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(file_);
  throw core::IoError("another emberfold runs batch is at work in " + folder.string());
}

BatchLock::~BatchLock() {
  ::close(file_);
}

}  // namespace emberfold::apps
