// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/catch.hpp"

namespace emberfold::test {

using OrderedJson = nlohmann::ordered_json;

/// What a report's page holds of the run.
inline OrderedJson data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const auto begin = page.find(open);
  REQUIRE(begin != std::string::npos);
  return OrderedJson::parse(
      page.substr(begin + open.size(), page.find("</script>", begin) - begin - open.size()));
}

}  // namespace emberfold::test
