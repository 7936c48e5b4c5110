// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace emberfold::apps {

extern const std::string_view kReviewTemplate, kReviewStyle, kReviewScript;

}  // namespace emberfold::apps
