// SPDX-License-Identifier: Apache-2.0
#include "core/io/column_folder.hpp"

#include <cerrno>
#include <fstream>
#include <functional>
#include <iterator>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/scratch.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAbout = "columns.json";
constexpr const char* kFormat = "emberfold.columns";
constexpr int kVersion = 1;

void write_file(const fs::path& path, const fs::path& told, const std::function<void(std::ostream&)>& body) {
  errno = 0;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  if (out) body(out);
  out.close();
  if (!out)
    throw core::IoError("cannot write " + told.string() + ": " +
                        (errno != 0 ? std::generic_category().message(errno) : "the disk may be full"));
}

}  // namespace

void write_columns(const fs::path& folder, const Columns& columns) {
  make_folder(folder.parent_path());
  const fs::path part = scratch_path(folder.parent_path());
  std::error_code error;
  try {
    make_folder(part);
    nlohmann::ordered_json about = {{"format", kFormat}, {"version", kVersion}, {"key", columns.key}};
    about["text"] = columns.text;
    about["columns"] = nlohmann::json::array();
    for (const auto& [name, array] : columns.arrays) {
      about["columns"].push_back(name);
      write_file(part / (name + ".npy"), folder / (name + ".npy"), [&array = array](std::ostream& out) {
        try {
          core::write_npy(out, array);
        } catch (const core::IoError&) {
          out.setstate(std::ios::failbit);  // told with the file's name and the system's reason
        }
      });
    }
    write_file(part / kAbout, folder / kAbout, [&](std::ostream& out) { out << about.dump(1) << '\n'; });
    fs::remove_all(folder, error);
    fs::rename(part, folder);
  } catch (const fs::filesystem_error& failed) {
    fs::remove_all(part, error);
    throw core::IoError("cannot write " + folder.string() + ": " + failed.code().message());
  } catch (...) {
    fs::remove_all(part, error);
    throw;
  }
}

std::optional<Columns> read_columns(const fs::path& folder, const std::string& key) {
  std::ifstream in(folder / kAbout, std::ios::binary);
  const auto about = nlohmann::json::parse(in, nullptr, false);
  if (!about.is_object() || about.value("format", "") != kFormat || about.value("version", 0) != kVersion ||
      about.value("key", "") != key)
    return std::nullopt;
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

}  // namespace emberfold::io
