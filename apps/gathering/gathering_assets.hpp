// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace emberfold::apps {

// The page of gathered runs: this folder's files, embedded by the build.
extern const std::string_view kGatheredTemplate;
extern const std::string_view kGatheredStyle;
extern const std::string_view kGatheredScript;

}  // namespace emberfold::apps
