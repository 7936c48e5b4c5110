// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <limits>
#include <optional>

#include "apps/comparison_json.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

std::optional<double> value_of(const Json& holder, const std::string& key) {
  if (!holder.is_object() || !holder.contains(key) || !holder[key].is_number()) return std::nullopt;
  return holder[key].get<double>();
}

std::string number(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string small_letters(std::string text) {
  text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

// "a, b and c"
std::string listed(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return out;
}

// "0.31 dB against 0.58"
std::string against(double value, double floor, const std::string& unit) {
  return number(value, 2) + (unit.empty() ? "" : " " + unit) + ", noise floor " + number(floor, 2);
}

struct Standing {
  std::vector<std::string> nearest, farthest, equal;  // names of measures
};

std::string model_words(const Held& model, const Standing& standing, std::size_t measures) {
  std::string out = "The " + model.label;
  out += standing.nearest.empty() ? " wins by no measure"
                                  : " comes nearest to the source in " + listed(standing.nearest);
  out += standing.farthest.empty() ? "" : "; it loses in " + listed(standing.farthest);
  out += ". ";
  if (standing.equal.size() == measures) return out + "No measure tells it from the source.";
  return out + (standing.equal.empty()
                    ? "Every measure tells it from the source."
                    : "By " + listed(standing.equal) +
                          " it cannot be told from the source: it lies no farther than the source's own "
                          "halves from each other.");
}

std::vector<std::string> synthesis_words(const Json& measures) {
  auto held = held_clips(measures);
  std::erase_if(held, [](const Held& one) { return one.key == "noise_floor"; });
  const auto& floor = distances_of(measures, "noise_floor");
  std::vector<Standing> standings(held.size());
  std::size_t told = 0;
  for (const auto& measure : all_measures()) {
    const auto least = value_of(floor, measure.key);
    std::vector<std::optional<double>> values;
    double best = std::numeric_limits<double>::infinity(), worst = -1;
    for (const auto& one : held) {
      values.push_back(value_of(distances_of(measures, one.key), measure.key));
      if (values.back()) best = std::min(best, *values.back()), worst = std::max(worst, *values.back());
    }
    if (worst < 0) continue;
    ++told;
    const auto name = small_letters(measure.name);
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (!values[i]) continue;
      if (*values[i] <= best && best < worst) standings[i].nearest.push_back(name);
      if (*values[i] >= worst && best < worst) standings[i].farthest.push_back(name);
      if (least && at_floor(*values[i], *least)) standings[i].equal.push_back(name);
    }
  }
  std::vector<std::string> words;
  for (std::size_t i = 0; i < held.size() && told > 0; ++i)
    words.push_back(model_words(held[i], standings[i], told));
  return words;
}

// Who foretells best, one step on and as far as was asked.
std::vector<std::string> prediction_words(const Json& measures) {
  if (!measures.contains("prediction") || !measures["prediction"].is_object()) return {};
  const auto& prediction = measures["prediction"];
  const auto& steps = prediction["steps"];
  std::vector<std::string> words;
  for (const std::size_t s : {std::size_t{0}, steps.size() - 1}) {
    if (s == 0 && !words.empty()) break;
    std::string best, text;
    double most = -1;
    for (const auto& model : measures["models"]) {
      const auto& value = prediction["methods"][model["key"].get<std::string>()]["by_step"]["psnr"][s];
      if (value.is_number() && value.get<double>() > most)
        most = value.get<double>(), best = model["label"].get<std::string>();
    }
    if (best.empty()) continue;
    const auto& before = prediction["methods"]["frame_before"]["by_step"]["psnr"][s];
    text = "Of the models the " + best + " foretells " +
           (steps[s] == 1 ? "the next frame" : "the frame " + steps[s].dump() + " on") + " best, at " +
           number(most, 1) + " dB";
    if (before.is_number())
      text += (before.get<double>() > most ? ", behind" : ", ahead of") +
              std::string(" showing the frame before again (") + number(before.get<double>(), 1) + " dB)";
    words.push_back(text + ".");
  }
  return words;
}

std::vector<std::string> stroke_words(const Json& measures) {
  std::vector<std::string> words;
  for (const auto& one : held_clips(measures)) {
    const auto& distances = distances_of(measures, one.key);
    if (one.key == "noise_floor" || !distances.contains("inside")) continue;
    std::vector<std::string> outside;
    for (const auto& [name, inside] : distances["inside"].items())
      if (!inside.get<bool>()) outside.push_back(name);
    words.push_back("Of the " + std::to_string(distances["inside"].size()) +
                    " means of strokes (six rates of "
                    "events, lifetime, length) found in " +
                    (one.key == "other" ? "" : "the clip of the ") + one.label + ", " +
                    std::to_string(distances["inside"].size() - outside.size()) +
                    " lie in the source's 95 % intervals" +
                    (outside.empty() ? "." : "; not so: " + listed(outside) + "."));
  }
  return words;
}

std::vector<std::string> pair_words(const Json& measures) {
  std::vector<std::string> same, apart;
  const auto &other = distances_of(measures, "other"), &floor = distances_of(measures, "noise_floor");
  for (const auto& measure : all_measures()) {
    const auto value = value_of(other, measure.key), least = value_of(floor, measure.key);
    if (!value) continue;
    const auto name = small_letters(measure.name);
    if (least && at_floor(*value, *least))
      same.push_back(name);
    else
      apart.push_back(name + (least ? " (" + against(*value, *least, measure.unit) + ")" : ""));
  }
  if (apart.empty()) return {"No measure tells the clips apart."};
  return {"The clips are told apart by " + listed(apart) + ".",
          same.empty()
              ? "By no measure are they the same."
              : "By " + listed(same) + " they lie no farther apart than the first clip's own halves."};
}

}  // namespace

bool at_floor(double distance, double floor) {
  constexpr double kRounding = 0.002;
  return distance <= 1.25 * floor + kRounding;
}

std::vector<std::string> comparison_words(const Json& measures) {
  if (measures.contains("other")) {
    auto words = pair_words(measures);
    for (auto& text : stroke_words(measures)) words.push_back(std::move(text));
    return words;
  }
  auto words = synthesis_words(measures);
  for (auto* more : {&prediction_words, &stroke_words})
    for (auto& text : more(measures)) words.push_back(std::move(text));
  return words;
}

}  // namespace emberfold::apps
