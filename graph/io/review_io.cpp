// SPDX-License-Identifier: Apache-2.0
#include "graph/io/review_io.hpp"

#include <cmath>
#include <istream>
#include <ostream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/event_reading.hpp"

namespace emberfold::graph {

namespace {

constexpr const char* kReview = "emberfold.review";
constexpr const char* kEvents = "emberfold.events";

std::string_view answer_text(const ReviewedEvent& reviewed) {
  switch (reviewed.answer) {
    case Answer::yes:
      return "yes";
    case Answer::no:
      return "no";
    case Answer::other:
      return name(reviewed.type);
    case Answer::added:
      return "added";
    default:
      return "";
  }
}

void read_answer(const nlohmann::json& object, ReviewedEvent& reviewed) {
  const auto found = object.find("answer");
  if (found == object.end() || found->is_null()) return;
  const std::string text = found->is_string() ? found->get_ref<const std::string&>() : found->dump();
  if (text == "yes")
    reviewed.answer = Answer::yes;
  else if (text == "no")
    reviewed.answer = Answer::no;
  else if (text == "added")
    reviewed.answer = Answer::added;
  else if (const auto type = event_type(text)) {
    reviewed.answer = *type == reviewed.event.type ? Answer::yes : Answer::other;
    reviewed.type = *type;
  } else
    throw core::IoError("the answer " + core::quoted(text) +
                        " is none of yes, no, added, birth, death, split, merge, connect, disconnect, null");
  if (reviewed.answer != Answer::other) reviewed.type = reviewed.event.type;
}

std::vector<ReviewedEvent> read_reviewed(std::istream& in, std::string_view name,
                                         const std::vector<std::string>& formats) {
  try {
    std::vector<ReviewedEvent> review;
    const auto format = detail::read_event_list(in, formats, [&](const nlohmann::json& object, Event event) {
      event.before.clear(), event.after.clear();  // identities of one run mean nothing in another
      review.push_back({std::move(event), Answer::none, {}});
      review.back().type = review.back().event.type;
      read_answer(object, review.back());
    });
    if (format == kEvents)
      for (ReviewedEvent& one : review) one.answer = Answer::yes, one.type = one.event.type;
    return review;
  } catch (const core::IoError& error) {
    throw core::IoError(std::string(name) + ": " + error.what());
  }
}

}  // namespace

void write_review(std::ostream& out, std::span<const ReviewedEvent> review) {
  std::string text = std::string("{\"format\":\"") + kReview + "\",\"version\":1,\"events\":[";
  for (const ReviewedEvent& one : review) {
    const Event& event = one.event;
    if (event.frame < 0 || !std::isfinite(event.position.x) || !std::isfinite(event.position.y) ||
        !(event.probability >= 0 && event.probability <= 1))
      throw core::InputError(
          "writing a review: a " + std::string(name(event.type)) + " in frame " +
          std::to_string(event.frame) +
          " has a negative frame, a place that is not finite or a probability outside 0 to 1");
    text += text.back() == '[' ? "\n{\"frame\":" : ",\n{\"frame\":";
    core::append_number(text, static_cast<std::uint32_t>(event.frame));
    text += ",\"type\":\"" + std::string(name(event.type)) + "\",\"x\":";
    core::append_number(text, event.position.x);
    text += ",\"y\":";
    core::append_number(text, event.position.y);
    text += ",\"probability\":";
    core::append_number(text, event.probability);
    const auto answer = answer_text(one);
    text += answer.empty() ? ",\"answer\":null}" : ",\"answer\":\"" + std::string(answer) + "\"}";
  }
  text += "\n]}\n";
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("a review could not be written: the stream failed");
}

std::vector<ReviewedEvent> read_review(std::istream& in, std::string_view name) {
  return read_reviewed(in, name, {kReview});
}

std::vector<ReviewedEvent> read_truth(std::istream& in, std::string_view name) {
  return read_reviewed(in, name, {kEvents, kReview});
}

}  // namespace emberfold::graph
