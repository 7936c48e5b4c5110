// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"

namespace emberfold::graph::detail {

/// Reads a JSON object with a list "events" and gives each of them, with the object it was read from, to
/// `take`, whose core::IoError is told with the event's number. `formats`: which the file may name; a file
/// that names none is of the first. Returns its format. Throws core::IoError for anything else.
std::string read_event_list(std::istream& in, const std::vector<std::string>& formats,
                            const std::function<void(const nlohmann::json&, Event)>& take);

}  // namespace emberfold::graph::detail
