// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace emberfold::apps {

/// One clip of a batch, as stored in batch.json.
struct BatchEntry {
  std::string run;  ///< its folder, below that of the batch
  std::string clip;
  std::string state = "waiting";  ///< or done, failed
  std::string key;                ///< hash of the clip, the options and the version that made the run
  double seconds = 0;             ///< wall time
  int exit = 0;
  std::string message;  ///< why it failed
};

constexpr const char* kBatchFile = "batch.json";

nlohmann::ordered_json manifest_json(const std::vector<BatchEntry>& entries);

/// Reads batch.json of a folder; nothing where there is none. Throws core::IoError for other content.
std::vector<BatchEntry> read_manifest(const std::filesystem::path& folder);

/// Replaces batch.json atomically, so that readers and a killed process always find it whole. Throws
/// core::IoError.
void write_manifest(const std::filesystem::path& folder, const std::vector<BatchEntry>& entries);

/// Locks a folder for one process, until it ends in any way.
/// The constructor throws core::IoError where another batch is using it.
class BatchLock {
 public:
  explicit BatchLock(const std::filesystem::path& folder);
  ~BatchLock();
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace emberfold::apps
