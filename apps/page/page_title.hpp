// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::apps {

/// Returns the title of a model's page: the last part of the path of its folder, or the whole name where it
/// is no path. Bytes that are no UTF-8 are replaced.
std::string page_title(const std::string& model);

/// Returns the path of a model's folder as a page that goes to others may show it: as it was given where that
/// lies below the folder it was given in, else its last part alone (of a run's model the run's name, too).
std::string shown_path(const std::string& model);

}  // namespace emberfold::apps
