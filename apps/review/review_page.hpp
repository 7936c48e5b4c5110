// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "core/clip.hpp"
#include "graph/events/events.hpp"
#include "graph/events/review.hpp"

namespace emberfold::apps {

/// Limits of the page: events with a strip, and bytes of JPEG of all strips; it stays below 8 MB.
constexpr std::size_t kReviewStrips = 400, kReviewBytes = 5'000'000;

/// Chooses the events to review, as indices in the order of the questions: the nearest to probability ½
/// first.
/// Where there are more than kReviewStrips, three quarters are the most doubtful, the rest evenly chosen,
/// so that events held to be certain are checked, too.
std::vector<std::size_t> choose_for_review(std::span<const graph::Event> events);

/// Returns review.html, a page on which a person answers by key whether each event happened, and saves
/// review.json. `answers`: of an earlier review, shown as given. Reads the clip once. Throws core::Cancelled.
std::string make_review_page(core::FrameSource& source, const std::string& clip, int frames,
                             std::span<const graph::Event> events,
                             std::span<const graph::ReviewedEvent> answers, const Session& session);

}  // namespace emberfold::apps
