// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/edit_groups.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "core/error.hpp"

namespace emberfold::dytex::detail {

using Eigen::Index;

namespace {

/// Components of the channel, then the earlier values of them that a higher order keeps.
Group channel_group(const LinearDynamicTexture& texture, int channel) {
  Group group;
  const Index n = texture.components();
  for (Index i = 0; i < texture.order(); ++i)
    if (texture.channels[i % n] == channel) group.states.push_back(i);
  group.shown = std::count(texture.channels.begin(), texture.channels.end(), channel);
  return group;
}

void check_apart(const LinearDynamicTexture& texture) {
  const Index n = texture.components();
  const bool apart = texture.order() % n == 0;
  for (Index i = 0; i < texture.order(); ++i)
    for (Index j = 0; j < texture.order(); ++j)
      if (!apart || (texture.channels[i % n] != texture.channels[j % n] && texture.A(i, j) != 0))
        throw core::InputError("the model's channels move by each other: A has entries between them");
}

}  // namespace

std::vector<Group> groups(const LinearDynamicTexture& texture, const std::optional<int>& channel) {
  if (texture.channels.size() == 0) {
    if (channel)
      throw core::InputError(
          "channel is " + std::to_string(*channel) +
          ", but every component of the model shows all channels: edit a model per channel");
    Group all{std::vector<Index>(static_cast<std::size_t>(texture.order())), texture.components()};
    std::iota(all.states.begin(), all.states.end(), Index{0});
    return {std::move(all)};
  }
  check_apart(texture);
  std::vector<Group> result;
  for (int c = 0; c < texture.info.channels; ++c) {
    if (channel && *channel != c) continue;
    if (Group group = channel_group(texture, c); !group.states.empty()) result.push_back(std::move(group));
  }
  if (channel && result.empty())
    throw core::InputError("channel is " + std::to_string(*channel) +
                           ", which no component of the model shows");
  return result;
}

}  // namespace emberfold::dytex::detail
