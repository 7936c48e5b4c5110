// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "apps/comparison/comparison_json.hpp"

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
std::string join_words(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return out;
}

// "0.31 dB, noise floor 0.58"; "20 %, noise floor 2".
std::string distance_text(double value, double floor, const std::string& unit) {
  const bool share = unit == "share";
  const auto text = [&](double one) { return share ? number(100 * one, 0) : number(one, 2); };
  return text(value) + (share ? " %" : unit.empty() ? "" : " " + unit) + ", noise floor " + text(floor);
}

struct Standing {
  std::vector<std::string> nearest, farthest, equal;  // names of measures
};

// `others`: whether there are other models to compare with.
std::string model_words(const DistanceColumn& model, const Standing& standing, std::size_t measures,
                        bool others) {
  const std::string name = "The " + model.label;
  std::string out;
  const bool equal = standing.equal.size() == measures;
  const bool stands_out = others && !(standing.nearest.empty() && standing.farthest.empty() && equal);
  if (stands_out) {
    out = name + (standing.nearest.empty() ? " is by no measure the nearest to the source"
                                           : " is nearest to the source in " + join_words(standing.nearest));
    out +=
        standing.farthest.empty() ? ". " : "; it is the farthest in " + join_words(standing.farthest) + ". ";
  }
  const std::string it = stands_out ? "it" : "the " + model.label;
  const std::string as_near = " lies about as near to the source as the source's own halves to each other.";
  if (equal) return out + "By every measure " + it + as_near;
  if (standing.equal.empty()) return out + "By every measure the source's own halves are more alike.";
  return out + "In " + join_words(standing.equal) + " " + it + as_near;
}

std::vector<std::string> synthesis_words(const Json& measures) {
  auto columns = distance_columns(measures);
  std::erase_if(columns, [](const DistanceColumn& one) { return one.key == "noise_floor"; });
  const auto& floor = distances_of(measures, "noise_floor");
  std::vector<Standing> standings(columns.size());
  std::size_t told = 0;
  for (const auto& measure : all_measures()) {
    const auto least = value_of(floor, measure.key);
    std::vector<std::optional<double>> values;
    double best = std::numeric_limits<double>::infinity(), worst = -1;
    for (const auto& one : columns) {
      values.push_back(value_of(distances_of(measures, one.key), measure.key));
      if (values.back()) best = std::min(best, *values.back()), worst = std::max(worst, *values.back());
    }
    if (worst < 0) continue;
    ++told;
    const auto name = small_letters(measure.name);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!values[i]) continue;
      if (*values[i] <= best && best < worst) standings[i].nearest.push_back(name);
      // A model within the noise floor is never listed as worst.
      if (least && at_floor(*values[i], *least))
        standings[i].equal.push_back(name);
      else if (*values[i] >= worst && best < worst)
        standings[i].farthest.push_back(name);
    }
  }
  std::vector<std::string> words;
  constexpr double kUnlike = 3;  // dB: half or twice the power
  if (const auto apart = value_of(floor, "temporal_db"); apart && *apart > kUnlike)
    words.push_back("The source changes its character: the spectra in time of its own halves lie " +
                    number(*apart, 1) +
                    " dB apart. To lie no farther from it than such a noise floor says little.");
  for (std::size_t i = 0; i < columns.size() && told > 0; ++i)
    words.push_back(model_words(columns[i], standings[i], told, columns.size() > 1));
  return words;
}

// Holds the `named` models (key, name) with the best PSNR at a step, to a tenth of a dB.
struct BestPredictors {
  std::vector<std::string> names;
  std::string decibels;
  double psnr = -1;
};
BestPredictors best_of(const Json& methods, std::size_t step,
                       const std::vector<std::pair<std::string, std::string>>& named) {
  BestPredictors best;
  for (const auto& [key, name] : named) {
    if (!methods.contains(key)) continue;
    const auto& value = methods[key]["by_step"]["psnr"][step];
    if (!value.is_number()) continue;
    const auto text = number(value.get<double>(), 1);
    if (text == best.decibels)
      best.names.push_back(name);
    else if (value.get<double>() > best.psnr)
      best = {{name}, text, value.get<double>()};
  }
  return best;
}

// Describes the best predictions, one step ahead and at the last step, compared with the better of two
// methods without a model.
std::vector<std::string> prediction_words(const Json& measures) {
  if (!measures.contains("prediction") || !measures["prediction"].is_object()) return {};
  const auto& [methods, steps] = std::tie(measures["prediction"]["methods"], measures["prediction"]["steps"]);
  std::vector<std::pair<std::string, std::string>> models;
  for (const auto& model : measures["models"])
    models.emplace_back(model["key"].get<std::string>(), "the " + model["label"].get<std::string>());
  std::vector<std::string> words;
  for (const std::size_t s : {std::size_t{0}, steps.size() - 1}) {
    if (s == 0 && !words.empty()) break;
    const auto best = best_of(methods, s, models);
    if (best.names.empty()) continue;
    const auto without = best_of(methods, s,
                                 {{"frame_before", "showing the frame before again"},
                                  {"mean_image", "the mean image of the first part"}});
    const std::string ahead =
        steps[s] == 1 ? "the next frame best" : "best " + steps[s].dump() + " frames ahead";
    std::string text = "Of the models " + join_words(best.names) +
                       (best.names.size() > 1 ? " predict " : " predicts ") + ahead + ", at " +
                       best.decibels + " dB";
    if (!without.names.empty())
      text += (without.decibels == best.decibels ? ", no better than "
               : without.psnr > best.psnr        ? ", behind "
                                                 : ", ahead of ") +
              join_words(without.names) + " (" + without.decibels + " dB)";
    words.push_back(text + ".");
  }
  return words;
}

std::vector<std::string> stroke_words(const Json& measures) {
  std::vector<std::string> words;
  const std::string of = measures.contains("other") ? "the first clip" : "the source";
  const auto& source = distances_of(measures, "source");
  if (source.contains("strokes") && source["strokes"]["strokes_a_frame"] == 0)
    return {"No stroke is found in " + of + "."};
  for (const auto& one : distance_columns(measures)) {
    const auto& distances = distances_of(measures, one.key);
    if (one.key == "noise_floor" || !distances.contains("inside")) continue;
    const auto& inside = distances["inside"];
    std::vector<std::string> outside;
    for (const auto& [name, within] : inside.items())
      if (!within.get<bool>()) outside.push_back(name == "lifetime" || name == "length" ? name : name + "s");
    words.push_back(
        (one.key == "other" ? "In the other clip " : "In the clip of the " + one.label + " ") +
        std::to_string(inside.size() - outside.size()) + " of " + std::to_string(inside.size()) +
        " figures of strokes (the rates of six events, lifetime, length) lie in the 95 % intervals of " + of +
        (outside.empty() ? "." : "; outside: " + join_words(outside) + "."));
  }
  return words;
}

std::string visible_text(const Json& visible) {
  const auto figure = [&](const char* key) { return visible[key].get<double>(); };
  return "completeness " + number(figure("complete"), 2) + " and coherence " + number(figure("coherent"), 2) +
         " (1 as the source's own halves), " + number(figure("flow"), 2) + " of its flow, " +
         number(figure("variance"), 2) + " of its variance, " + number(figure("difference"), 2) +
         " of its change from frame to frame; " + number(100 * figure("copied"), 0) +
         " % of what moves is as in one frame of it";
}

// Describes the verdict: which new clip is visibly closest to the source, compared with the loop that only
// repeats it.
std::vector<std::string> verdict_words(const Json& measures) {
  if (measures.contains("other")) {
    const auto& other = distances_of(measures, "other");
    if (!other.contains("visible")) return {};
    return {"To the eye the other clip beside the first: " + visible_text(other["visible"]) + "."};
  }
  const Json* best = nullptr;
  std::string label, loop;
  const auto rank = [](const Json& visible) { return visible["apart"].get<double>(); };
  for (const auto& one : distance_columns(measures)) {
    const auto& distances = distances_of(measures, one.key);
    if (!distances.contains("visible")) continue;
    const auto& visible = distances["visible"];
    if (one.key == "video_loop")
      loop = " The loop of the clip itself, the peer to beat, has completeness " +
             number(visible["complete"].get<double>(), 2) + " and is copied by " +
             number(100 * visible["copied"].get<double>(), 0) + " %.";
    else if (best == nullptr || rank(visible) < rank(*best))
      best = &visible, label = one.label;
  }
  if (best == nullptr) return {};
  return {"To the eye the new clip of the " + label + " is nearest to the source" +
          ((*best)["moves_alike"].get<bool>() ? ": " : ", though none moves as it does: ") +
          visible_text(*best) + "." + loop};
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
      apart.push_back(name + (least ? " (" + distance_text(*value, *least, measure.unit) + ")" : ""));
  }
  if (apart.empty()) return {"No measure tells the clips apart."};
  return {"The clips are told apart by " + join_words(apart) + ".",
          same.empty()
              ? "By every measure the first clip's own halves are more alike."
              : "In " + join_words(same) + " they are about as alike as the first clip's own halves."};
}

}  // namespace

bool at_floor(double distance, double floor) {
  constexpr double kRounding = 0.002;
  return distance <= 1.25 * floor + kRounding;
}

std::vector<std::string> comparison_words(const Json& measures) {
  if (measures.contains("other")) {
    auto words = verdict_words(measures);
    for (auto& text : pair_words(measures)) words.push_back(std::move(text));
    for (auto& text : stroke_words(measures)) words.push_back(std::move(text));
    return words;
  }
  auto words = verdict_words(measures);
  for (auto* more : {&synthesis_words, &prediction_words, &stroke_words})
    for (auto& text : more(measures)) words.push_back(std::move(text));
  return words;
}

}  // namespace emberfold::apps
