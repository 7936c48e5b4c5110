// SPDX-License-Identifier: Apache-2.0
#include "apps/review/review_page.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/report/report.hpp"
#include "apps/review/event_strips.hpp"
#include "apps/review/review_assets.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 16'000, kLeastBytes = 4'096;  // of a strip
constexpr std::size_t kMostOthers = 20'000;  // likeliest events without a strip that are kept

double doubt(const graph::Event& event) {
  return -std::abs(event.probability - 0.5);
}

/// Returns the event in the format of review.json, with the numbering of the tables.
Json event_json(const graph::Event& event, const core::ClipOrigin& origin) {
  constexpr int kDigits = 8;
  return {{"frame", event.frame},
          {"type", graph::name(event.type)},
          {"x", core::round_significant(event.position.x + origin.x, kDigits)},
          {"y", core::round_significant(event.position.y + origin.y, kDigits)},
          {"probability", event.probability}};
}

Json answer_json(const graph::ReviewedEvent& said) {
  using graph::Answer;
  switch (said.answer) {
    case Answer::yes:
      return "yes";
    case Answer::no:
      return "no";
    case Answer::added:
      return "added";
    case Answer::other:
      return graph::name(said.type);
    default:
      return nullptr;
  }
}

Json class_list() {
  Json list = Json::array();
  for (const auto type : graph::all_event_types())
    list.push_back({{"name", graph::name(type)}, {"colour", hex(event_colour(type))}});
  return list;
}

/// Lists the events without a picture on the page, and answers about events that were not found; the page
/// passes them on unchanged.
Json other_events(std::span<const graph::Event> events, const std::vector<bool>& has_strip,
                  std::span<const graph::ReviewedEvent> answers, const std::vector<std::size_t>& said,
                  const core::ClipOrigin& origin) {
  std::vector<std::size_t> rest;
  std::vector<bool> is_known(answers.size() + 1, false);
  for (std::size_t k = 0; k < events.size(); ++k) {
    is_known[said[k]] = true;
    if (!has_strip[k]) rest.push_back(k);
  }
  std::ranges::stable_sort(
      rest, {}, [&](std::size_t k) { return std::pair(said[k] == answers.size(), -events[k].probability); });
  if (rest.size() > kMostOthers) rest.resize(kMostOthers);
  Json others = Json::array();
  for (const std::size_t k : rest) {
    others.push_back(event_json(events[k], origin));
    if (said[k] < answers.size()) others.back()["answer"] = answer_json(answers[said[k]]);
  }
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (is_known[k] || answers[k].answer == graph::Answer::none) continue;
    others.push_back(event_json(answers[k].event, origin));
    others.back()["answer"] = answer_json(answers[k]);
  }
  return others;
}

}  // namespace

std::vector<std::size_t> choose_for_review(std::span<const graph::Event> events) {
  std::vector<std::size_t> order(events.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return -doubt(events[k]); });
  if (order.size() <= kReviewStrips) return order;
  constexpr std::size_t kDoubtful = kReviewStrips / 4 * 3;
  std::vector<int> rest;
  for (std::size_t k = kDoubtful; k < order.size(); ++k) rest.push_back(static_cast<int>(k));
  std::vector<std::size_t> chosen(order.begin(), order.begin() + kDoubtful);
  for (const int k : spread_evenly(rest, kReviewStrips - kDoubtful))
    chosen.push_back(order[static_cast<std::size_t>(k)]);
  return chosen;
}

std::string make_review_page(core::FrameSource& source, const std::string& clip, int frames,
                             std::span<const graph::Event> events,
                             std::span<const graph::ReviewedEvent> answers, const Session& session) {
  const auto chosen = choose_for_review(events);
  std::vector<graph::Event> shown;
  std::vector<bool> has_strip(events.size(), false);
  for (const std::size_t k : chosen) shown.push_back(events[k]), has_strip[k] = true;
  const std::size_t bytes =
      std::clamp(kReviewBytes / std::max<std::size_t>(1, shown.size()), kLeastBytes, kMostBytes);
  const auto strips = draw_event_strips(source, shown, bytes, session);
  const auto said = graph::find_answers(events, answers);
  const auto& info = source.info();
  Json list = Json::array();
  for (std::size_t k = 0; k < shown.size(); ++k) {
    Json one = event_json(shown[k], info.origin);
    const std::size_t entry = said[chosen[k]];
    if (entry < answers.size()) one["answer"] = answer_json(answers[entry]);
    one["strip"] = data_uri(strips[k]);
    list.push_back(std::move(one));
  }
  const Json data = {{"clip",
                      {{"name", clip},
                       {"width", info.width},
                       {"height", info.height},
                       {"fps", info.fps},
                       {"frames", frames}}},
                     {"classes", class_list()},
                     {"cell", kStripCell},
                     {"cells", kStripFrames},
                     {"reach", strip_reach(info)},
                     {"events", std::move(list)},
                     {"others", other_events(events, has_strip, answers, said, info.origin)}};
  const auto title = Json::parse(Json(clip).dump(-1, ' ', false, Json::error_handler_t::replace));
  return fill_in(kReviewTemplate, {{"title", escape_html(title.get<std::string>())},
                                   {"style", kReviewStyle},
                                   {"data", embed_json(data)},
                                   {"script", kReviewScript}});
}

}  // namespace emberfold::apps
