// SPDX-License-Identifier: Apache-2.0
#include "core/io/column_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <span>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/scratch.hpp"
#include "core/npy_header.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAbout = "columns.json";
constexpr const char* kFormat = "emberfold.columns";
constexpr int kVersion = 1;

std::span<const std::size_t> row_of(std::span<const std::size_t> shape) {
  return shape.empty() ? shape : shape.subspan(1);
}

/// Reads the description of a folder of columns; null where it is none. Its key is a text.
nlohmann::json read_about(const fs::path& folder) {
  std::ifstream in(folder / kAbout, std::ios::binary);
  auto about = nlohmann::json::parse(in, nullptr, false);
  const bool is_ours = about.is_object() && about.contains("format") && about["format"] == kFormat &&
                       about.contains("version") && about["version"] == kVersion && about.contains("key") &&
                       about["key"].is_string();
  return is_ours ? about : nlohmann::json();
}

}  // namespace

ColumnWriter::ColumnWriter(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_.parent_path());
  part_ = scratch_path(folder_.parent_path());
  make_folder(part_);
}

ColumnWriter::~ColumnWriter() {
  columns_.clear();
  std::error_code ignored;
  fs::remove_all(part_, ignored);
}

template <class Write>
void ColumnWriter::write(const std::string& name, std::ofstream& file, const Write& body) const {
  errno = 0;
  try {
    if (!file.is_open()) file.open(part_ / name, std::ios::binary | std::ios::trunc);
    if (file) body(file);
  } catch (const core::IoError&) {
    file.setstate(std::ios::failbit);  // reported with the file's name and the system's reason
  }
  if (!file)
    throw core::IoError("cannot write " + (folder_ / name).string() + ": " +
                        (errno != 0 ? std::generic_category().message(errno) : "the disk may be full"));
}

void ColumnWriter::append(const std::map<std::string, core::NpyArray>& arrays) {
  for (const auto& [name, array] : arrays) {
    const auto [found, is_new] = columns_.try_emplace(name);
    auto& [file, whole] = found->second;
    const core::NpyView more = core::view(array);
    if (is_new) {
      whole = more;
      write(name + ".npy", file, [&](std::ostream& out) { core::write_npy_view(out, more); });
      continue;
    }
    if (more.shape.empty() || !std::ranges::equal(row_of(more.shape), row_of(whole.shape)) ||
        more.data.index() != whole.data.index())
      throw core::InputError("the rows of the column " + name + " are not alike");
    whole.shape.front() += more.shape.front();
    write(name + ".npy", file, [&](std::ostream& out) { core::write_npy_values(out, more.data); });
  }
}

void ColumnWriter::finish(const std::string& key, const std::string& text) {
  nlohmann::ordered_json about = {{"format", kFormat}, {"version", kVersion}, {"key", key}};
  about["text"] = text;
  about["columns"] = nlohmann::json::array();
  for (auto& [name, column] : columns_) {
    about["columns"].push_back(name);
    write(name + ".npy", column.file, [&column = column](std::ofstream& out) {
      out.seekp(0);  // the number of rows is known only now; room was left for it
      out << core::npy_header(column.whole);
      out.close();
    });
  }
  columns_.clear();
  std::ofstream file;
  write(kAbout, file, [&](std::ofstream& out) {
    out << about.dump(1) << '\n';
    out.close();
  });
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  try {
    fs::rename(part_, folder_);
  } catch (const fs::filesystem_error& failed) {
    throw core::IoError("cannot write " + folder_.string() + ": " + failed.code().message());
  }
}

void write_columns(const fs::path& folder, const Columns& columns) {
  ColumnWriter writer(folder);
  writer.append(columns.arrays);
  writer.finish(columns.key, columns.text);
}

std::optional<Columns> read_columns(const fs::path& folder, const std::string& key) {
  const auto about = read_about(folder);
  if (about.is_null() || about.at("key") != key) return std::nullopt;
  try {
    Columns columns{key, about.at("text").get<std::string>(), {}};
    for (const auto& name : about.at("columns")) {
      std::ifstream file(folder / (name.get<std::string>() + ".npy"), std::ios::binary);
      if (!file) return std::nullopt;
      columns.arrays[name.get<std::string>()] = core::read_npy(file);
    }
    return columns;
  } catch (const core::IoError&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::optional<std::string> read_column_key(const fs::path& folder) {
  const auto about = read_about(folder);
  if (about.is_null()) return std::nullopt;
  return about.at("key").get<std::string>();
}

}  // namespace emberfold::io
