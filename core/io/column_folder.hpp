// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/npy.hpp"

namespace emberfold::io {

/// Arrays of a table, one .npy file each, and what they were made from.
struct Columns {
  std::string key;   ///< hash of the inputs and options
  std::string text;  ///< JSON of everything that is not an array; may be empty
  std::map<std::string, core::NpyArray> arrays;
};

/// Writes columns.json and NAME.npy for each array into a folder, in batches of rows. The folder appears
/// whole or not at all: a killed process leaves the previous one. Throws core::IoError.
class ColumnWriter {
 public:
  explicit ColumnWriter(std::filesystem::path folder);
  ~ColumnWriter();
  ColumnWriter(const ColumnWriter&) = delete;
  ColumnWriter& operator=(const ColumnWriter&) = delete;

  /// Appends rows to each of these arrays, along the first axis. Throws core::InputError unless all rows of a
  /// name have one shape and type.
  void append(const std::map<std::string, core::NpyArray>& arrays);
  /// Puts the folder into place, where read_columns finds it.
  void finish(const std::string& key, const std::string& text);

 private:
  struct Column {
    std::ofstream file;
    core::NpyView whole;  // its shape and type
  };
  template <class Write>
  void write(const std::string& name, std::ofstream& file, const Write& body) const;

  std::filesystem::path folder_, part_;
  std::map<std::string, Column> columns_;
};

/// Writes columns as ColumnWriter does.
void write_columns(const std::filesystem::path& folder, const Columns& columns);

/// Reads a folder that write_columns wrote with this key. Returns nothing where there is none, its key
/// differs or one of its files is damaged: it must then be made again.
std::optional<Columns> read_columns(const std::filesystem::path& folder, const std::string& key);
/// Returns the key with which a folder was written; nothing where write_columns did not write it.
std::optional<std::string> read_column_key(const std::filesystem::path& folder);

}  // namespace emberfold::io
