// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_edits.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <iterator>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

std::string shortest_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + shortest_text(value);
  return text;
}

// Writes one edit after another.
class Words {
 public:
  void add(const dytex::Edit& edit) {
    std::visit([&](const auto& what) { add(what, edit); }, edit.what);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void put(const std::string& option, const std::string& value = {}) {
    text_ += (text_.empty() ? "" : " ") + option + (value.empty() ? "" : " " + value);
  }
  void put(const std::string& option, double value) { put(option, shortest_text(value)); }
  void say_contrast(const dytex::Edit& edit) {
    if (edit.keep_contrast != contrast_) put(edit.keep_contrast ? "--contrast" : "--no-contrast");
    contrast_ = edit.keep_contrast;
  }
  void add(const dytex::Speed& speed, const dytex::Edit& edit) {
    say_contrast(edit);
    put("--speed", speed.factor);
  }
  void add(const dytex::Flow& flow, const dytex::Edit& edit) {
    say_contrast(edit);
    put("--flow", flow.factor);
  }
  void add(const dytex::Reverse&, const dytex::Edit&) { put("--reverse"); }
  void add(const dytex::Intensity& intensity, const dytex::Edit&) { put("--intensity", intensity.factor); }
  void add(const dytex::Directions& directions, const dytex::Edit&) {
    put("--directions", list_text(directions.factors));
  }
  void add(const dytex::Weights& weights, const dytex::Edit&) {
    put("--weights", list_text(weights.factors));
  }
  void add(const dytex::Scales& scales, const dytex::Edit&) {
    if (scales.coarse != 1) put("--coarse", scales.coarse);
    if (scales.medium != 1) put("--medium", scales.medium);
    if (scales.fine != 1) put("--fine", scales.fine);
  }

  std::string text_;
  bool contrast_ = true;
};

// Parses the numbers of a text; nothing where it holds anything else, or no numbers.
std::optional<std::vector<double>> numbers_of(std::string text) {
  std::ranges::replace(text, ',', ' ');
  std::vector<double> values;
  const char* at = text.c_str();
  while (true) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) break;
    values.push_back(value);
    at = end;
  }
  const bool whole = std::string(at).find_first_not_of(" \t\r\n") == std::string::npos;
  if (!whole || values.empty()) return std::nullopt;
  return values;
}

}  // namespace

std::string edit_words(std::span<const dytex::Edit> edits) {
  Words words;
  for (const dytex::Edit& edit : edits) words.add(edit);
  return words.text();
}

std::vector<double> parse_numbers(const std::string& text) {
  if (auto values = numbers_of(text)) return *values;
  auto in = io::open_file(text);
  constexpr std::size_t kLongest = 1 << 20;
  std::string content(kLongest + 1, '\0');
  in.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(in.gcount()));
  auto values = content.size() <= kLongest ? numbers_of(content) : std::nullopt;
  if (!values)
    throw core::IoError(text +
                        " holds no list of numbers; expected are numbers with commas or spaces between them");
  return *values;
}

std::vector<std::string> edit_history(const std::string& model_text) {
  const auto json = Json::parse(model_text, nullptr, false);
  const auto edits = json.is_object() ? json.find("edits") : json.end();
  if (!json.is_object() || edits == json.end()) return {};
  const bool texts =
      edits->is_array() && std::ranges::all_of(*edits, [](const Json& e) { return e.is_string(); });
  if (!texts) throw core::IoError("model: \"edits\" must be a list of texts");
  return edits->get<std::vector<std::string>>();
}

std::string with_edit_history(const std::string& model_text, const std::vector<std::string>& history) {
  Json json = Json::parse(model_text);
  json["edits"] = history;
  return json.dump(2) + "\n";
}

}  // namespace emberfold::apps
