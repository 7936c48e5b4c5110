// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "core/error.hpp"
#include "dytex/editing/edit.hpp"

namespace emberfold::dytex {

namespace {

struct Preset {
  PresetInfo info;
  double intensity = 1;
  Scales scales;
  double speed = 1;
};

// (2003) is "Editable dynamic textures", CVPR 2003, Fig. 2 and section 4; (2002) its longer form, Figs. 2
// to 5. "Amplified" and "increased" are their words. Where they say only that intensity and scales were
// played with, so does the table.
constexpr std::array<Preset, 16> kPresets{{
    // Smoke. "a frame where the intensity of the driving input has been increased, … more 'turbulent'"
    {{"turbulent", "smoke: intensity up"}, 2.5, {1, 1, 1}},
    // "where the coarse frequency component has been amplified, which results in a thinner 'hazy' smoke"
    {{"hazy", "smoke: coarse up"}, 1, {2, 1, 1}},
    // "where the intermediate frequency has been amplified" (2002)
    {{"billowing", "smoke: medium up"}, 1, {1, 2, 1}},
    // "where the high frequency has been amplified, resulting in a grainy, 'patchy' smoke"
    {{"patchy", "smoke: fine up"}, 1, {1, 1, 2}},
    // Ocean. "the intensity and the coarse and fine scales have been amplified, … larger waves"
    {{"rough-sea", "ocean: intensity, coarse and fine up"}, 2, {1.5, 1, 1.5}},
    // "the 'lake effect', where the waves appear more gentle and smooth": not said how
    {{"lake", "ocean: intensity, medium and fine down"}, 0.5, {1, 0.7, 0.3}},
    // "increasing the intensity and the fine scale, while decreasing the coarse and middle scale"
    {{"rain", "ocean: intensity and fine up, coarse and medium down"}, 2, {0.3, 0.4, 2}},
    // Fountain. "playing with the intensity and scale parameters": not said which way
    {{"spray", "fountain: fine up, coarse down"}, 1.5, {0.6, 1, 2}},
    {{"frothy", "fountain: medium up"}, 1.2, {0.8, 1.8, 1.2}},
    {{"spurty", "fountain: intensity and coarse up, fine down"}, 2.5, {1.5, 1, 0.5}},
    // Fire (2002). "changing the spatial scales, speed, direction etc."
    {{"fire-coarse", "fire: coarse up"}, 1, {2, 1, 1}},
    {{"fire-medium", "fire: medium up"}, 1, {1, 2, 1}},
    {{"fire-fine", "fire: fine up"}, 1, {1, 1, 2}},
    {{"fire-slow", "fire: half the speed"}, 1, {}, 0.5},
    {{"fire-fast", "fire: twice the speed"}, 1, {}, 2},
    {{"fire-reversed", "fire: backwards"}, 1, {}, -1},
}};

constexpr auto kInfos = [] {
  std::array<PresetInfo, kPresets.size()> infos{};
  for (std::size_t i = 0; i < infos.size(); ++i) infos[i] = kPresets[i].info;
  return infos;
}();

}  // namespace

std::span<const PresetInfo> presets() {
  return kInfos;
}

std::vector<Edit> preset(std::string_view name) {
  std::string names;
  for (const Preset& known : kPresets) {
    if (known.info.name == name) {
      std::vector<Edit> edits;
      if (known.intensity != 1) edits.push_back({Intensity{known.intensity}});
      if (known.scales != Scales{}) edits.push_back({known.scales});
      if (known.speed != 1) edits.push_back({Speed{known.speed}});
      return edits;
    }
    names += (names.empty() ? "" : ", ") + std::string(known.info.name);
  }
  throw core::InputError("preset is " + std::string(name) + "; allowed is " + names);
}

}  // namespace emberfold::dytex
