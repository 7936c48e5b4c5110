// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::apps {

/// Returns the title of a model's page: the last part of the path of its folder, or the whole name where it is
/// no path. Bytes that are no UTF-8 are replaced.
std::string page_title(const std::string& model);

}  // namespace emberfold::apps
