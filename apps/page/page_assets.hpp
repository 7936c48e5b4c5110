// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

// The files of apps/page/, embedded into the program by the build (cmake/embed_files.cmake).
namespace emberfold::apps {
extern const std::string_view kPageTemplate, kPageStyle, kPageScript;
}  // namespace emberfold::apps
