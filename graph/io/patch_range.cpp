// SPDX-License-Identifier: Apache-2.0
#include "graph/io/patch_range.hpp"

#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/text/json_reader.hpp"

namespace emberfold::graph::detail {

namespace {
std::string whole(double value) {
  return std::to_string(static_cast<long long>(value));
}
}  // namespace

std::string describe_range_error(const Patch& patch) {
  constexpr double kLargest = 1e6, kMostNats = 1e9;
  const auto check = [](const char* field, double value, double least, double most) -> std::string {
    if (value >= least && value <= most) return {};
    std::string result = "\"" + std::string(field) + "\" is ";
    if (std::isfinite(value)) {
      core::append_number(result, value);
    } else {
      result += "not finite";
    }
    return result + ", allowed is " + (least < 0 ? "-" + whole(most) : "0") + " to " + whole(most);
  };
  struct Field {
    const char* name = "";
    double value = 0, least = 0, most = kLargest;
  };
  const std::array<Field, 9> fields{{{"x", patch.position.x, -kLargest},
                                     {"y", patch.position.y, -kLargest},
                                     {"theta", patch.theta, -kLargest},
                                     {"width", patch.width, 0},
                                     {"blur", patch.blur, 0},
                                     {"contrast", patch.contrast, -kLargest},
                                     {"cost", patch.cost, 0, kMostNats},
                                     {"gain", patch.gain, -kMostNats, kMostNats},
                                     {"evidence", patch.evidence, 0, kMostNats}}};
  for (const Field& field : fields) {
    if (auto text = check(field.name, field.value, field.least, field.most); !text.empty()) return text;
  }
  for (const auto& [name, level] :
       {std::pair{"left", patch.left}, {"middle", patch.middle}, {"right", patch.right}}) {
    for (const float value : level) {
      if (auto text = check(name, static_cast<double>(value), -kLargest, kLargest); !text.empty())
        return text;
    }
  }
  return {};
}

std::string describe_range_error(const Patch& patch, int width, int height) {
  if (auto text = describe_range_error(patch); !text.empty() || !is_anchor(patch)) return text;
  for (const auto& [name, value, size] :
       {std::tuple{"x", patch.position.x, width}, {"y", patch.position.y, height}}) {
    if (value >= 0 && value < size && value == std::floor(value)) continue;
    std::string text = "\"" + std::string(name) + "\" of an anchor is ";
    core::append_number(text, value);
    return text + ", allowed is a whole number from 0 to " + std::to_string(size - 1);
  }
  return {};
}

}  // namespace emberfold::graph::detail
