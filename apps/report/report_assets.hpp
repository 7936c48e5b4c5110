// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

// The files of apps/report/, put into the program when it is built (cmake/embed_files.cmake).
namespace emberfold::apps {
extern const std::string_view kReportTemplate, kReportStyle, kReportScript;
}  // namespace emberfold::apps
