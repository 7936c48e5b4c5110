// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

/// Numbers of the state that move independently of others: all, or a channel's. The first `shown` are
/// components.
struct Group {
  std::vector<Eigen::Index> states;
  Eigen::Index shown = 0;
};

/// Returns the groups that an edit of the channel, or of all, acts on. Throws InputError where the model does
/// not have that channel, or its channels do not move independently.
std::vector<Group> groups(const LinearDynamicTexture& texture, const std::optional<int>& channel);

}  // namespace emberfold::dytex::detail
