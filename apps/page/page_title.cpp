// SPDX-License-Identifier: Apache-2.0
#include "apps/page/page_title.hpp"

#include <filesystem>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

namespace {

// Replaces bytes that are not UTF-8.
std::string as_utf8(const std::string& text) {
  using Json = nlohmann::json;
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

// Returns the path without a trailing slash.
std::filesystem::path folder_path(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

std::string page_title(const std::string& model) {
  const std::string name = folder_path(model).filename();
  return as_utf8(name.empty() || name == "." || name == ".." ? model : name);
}

std::string shown_path(const std::string& model) {
  const std::filesystem::path path = folder_path(model);
  if (path.is_relative() && *path.begin() != "..") return as_utf8(path.string());
  const std::filesystem::path run = path.parent_path().filename();
  return as_utf8(path.filename() == "model" && !run.empty() && run != ".." ? (run / path.filename()).string()
                                                                           : path.filename().string());
}

}  // namespace emberfold::apps
