// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <span>
#include <string_view>
#include <vector>

#include "graph/events/review.hpp"

namespace emberfold::graph {

/// Writes review.json: the events as in events.json, each with an answer.
/// Throws InputError as write_events does, IoError if the stream fails.
void write_review(std::ostream& out, std::span<const ReviewedEvent> review);

/// Reads review.json. "answer" is "yes", "no", "added", the name of another class, or null or missing.
/// Throws IoError, beginning with `name`, for anything else.
std::vector<ReviewedEvent> read_review(std::istream& in, std::string_view name);

/// Reads true events: events.json or truth.json, each of them answered yes, or review.json.
/// Errors as for read_review.
std::vector<ReviewedEvent> read_truth(std::istream& in, std::string_view name);

}  // namespace emberfold::graph
