// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/npy.hpp"

namespace emberfold::io {

/// Arrays of a table, a .npy file each, and what they were made from.
struct Columns {
  std::string key;   ///< hash of the inputs and options
  std::string text;  ///< JSON of what is no array; may be empty
  std::map<std::string, core::NpyArray> arrays;
};

/// Writes columns.json and NAME.npy for each array into a folder, which appears whole or not at all: a killed
/// process leaves the one before. Throws core::IoError.
void write_columns(const std::filesystem::path& folder, const Columns& columns);

/// Reads a folder that write_columns wrote with this key. Nothing where there is none, its key is another, or
/// a file of it is damaged: then it has to be made again.
std::optional<Columns> read_columns(const std::filesystem::path& folder, const std::string& key);

}  // namespace emberfold::io
