// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::apps {

/// Returns the title of a model's page: the last part of the path of its folder, or the whole name if it is
/// no path. Bytes that are not UTF-8 are replaced.
std::string page_title(const std::string& model);

/// Returns the path of a model's folder as shown on a page that may be shared: unchanged where it is a
/// relative path downwards, else its last part alone (for a run's model with the run's name).
std::string shown_path(const std::string& model);

}  // namespace emberfold::apps
