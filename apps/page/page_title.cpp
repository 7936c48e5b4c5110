// SPDX-License-Identifier: Apache-2.0
#include "apps/page/page_title.hpp"

#include <filesystem>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

std::string page_title(const std::string& model) {
  using Json = nlohmann::json;
  const std::filesystem::path path = std::filesystem::path(model).lexically_normal();
  const std::string name = path.has_filename() ? path.filename() : path.parent_path().filename();
  const std::string title = name.empty() || name == "." || name == ".." ? model : name;
  return Json::parse(Json(title).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

}  // namespace emberfold::apps
