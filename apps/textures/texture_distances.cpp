// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>

#include <nlohmann/json.hpp>

#include "apps/pictures/curve_plot.hpp"
#include "apps/pictures/heat_matrix.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Json finite_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string number_column(double value, int width) {
  std::array<char, 40> text{};
  if (std::isfinite(value))
    std::snprintf(text.data(), text.size(), "%*.*g", width, 6, value);
  else
    std::snprintf(text.data(), text.size(), "%*s", width, std::isinf(value) ? "infinite" : "-");
  return text.data();
}

// Counts UTF-8 characters.
std::size_t count_characters(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string pad_right(const std::string& text, std::size_t width) {
  return text + std::string(width > count_characters(text) ? width - count_characters(text) : 0, ' ');
}

std::string pad_left(const std::string& text, std::size_t width) {
  return std::string(width > count_characters(text) ? width - count_characters(text) : 0, ' ') + text;
}

// Quotes a field of a CSV line if necessary.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

const char* measure_caption(dytex::Measure measure) {
  switch (measure) {
    case dytex::Measure::kl:
      return "KL rate of the row's model from the column's, nats a frame";
    case dytex::Measure::martin:
      return "Martin distance";
    case dytex::Measure::windows:
      return "windows' distance, dB: root mean square of what their shares differ by, wherever they lie";
    case dytex::Measure::angles:
      break;
  }
  return "Grassmann distance, rad: root of the sum of squared subspace angles";
}

}  // namespace

std::optional<dytex::Measure> measure_of(const std::string& text) {
  for (const auto measure : dytex::kMeasures)
    if (text == dytex::name(measure)) return measure;
  return std::nullopt;
}

std::string measure_names() {
  std::string names;
  for (const auto measure : dytex::kMeasures)
    names += (names.empty() ? "" : ", ") + std::string(name(measure));
  return names;
}

std::vector<std::string> short_names(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> whole, rest;
  std::vector<std::string> names;
  for (const auto& path : paths) {
    whole.push_back(std::filesystem::path(path).lexically_normal());
    if (!whole.back().has_filename()) whole.back() = whole.back().parent_path();
    names.push_back(whole.back().filename().string());
  }
  rest = whole;
  // Equal names are prefixed with their parent folders until all differ.
  for (bool longer = true; longer;) {
    longer = false;
    std::vector<std::size_t> alike;
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t j = 0; j < names.size(); ++j)
        if (names[i] == names[j] && whole[i] != whole[j]) {
          alike.push_back(i);
          break;
        }
    for (const std::size_t i : alike) {
      rest[i] = rest[i].parent_path();
      if (!rest[i].has_filename()) continue;
      names[i] = rest[i].filename().string() + "/" + names[i];
      longer = true;
    }
  }
  return names;
}

cv::Mat measure_matrix(std::span<const dytex::Distances> pairs, dytex::Measure measure) {
  const Eigen::MatrixXd matrix = dytex::distance_matrix(pairs, measure);
  const auto models = static_cast<int>(matrix.rows());
  cv::Mat values(models, models, CV_64F);
  for (int i = 0; i < models; ++i)
    for (int j = 0; j < models; ++j) values.at<double>(i, j) = matrix(i, j);
  return values;
}

Json distances_json(const std::vector<std::string>& models, std::span<const dytex::Distances> pairs) {
  Json measures = Json::object();
  for (const auto measure : dytex::kMeasures) {
    const cv::Mat values = measure_matrix(pairs, measure);
    Json rows = Json::array();
    for (int i = 0; i < values.rows; ++i) {
      Json row = Json::array();
      for (int j = 0; j < values.cols; ++j) row.push_back(finite_json(values.at<double>(i, j)));
      rows.push_back(std::move(row));
    }
    measures[name(measure)] = std::move(rows);
  }
  Json out = {{"format", "emberfold.texture_distances"},
              {"version", 1},
              {"models", models},
              {"measures", std::move(measures)}};
  if (models.size() == 2) out["angles"] = std::vector<double>(pairs[1].angles.begin(), pairs[1].angles.end());
  return out;
}

std::string pair_table(const std::vector<std::string>& names, const dytex::Distances& pair) {
  constexpr int kWidth = 14;
  std::string out = pad_right(names[0] + " (1) and " + names[1] + " (2)", 38) + pad_left("1 from 2", kWidth) +
                    pad_left("2 from 1", kWidth) + "\n";
  const auto line = [&](const std::string& what, double there, std::optional<double> back = {}) {
    out += pad_right("  " + what, 38) + number_column(there, kWidth) +
           (back ? number_column(*back, kWidth) : "") + "\n";
  };
  line("KL rate, nats a frame", pair.kl.value_or(kNone), pair.kl_back.value_or(kNone));
  const bool angles = pair.angles.size() > 0;
  line("Martin distance", angles ? dytex::martin_distance(pair.angles) : kNone);
  constexpr double kDegrees = 180 / std::numbers::pi;
  line("subspace angles, degrees: smallest", angles ? kDegrees * pair.angles[0] : kNone);
  line("  median", angles ? kDegrees * pair.angles[(pair.angles.size() - 1) / 2] : kNone);
  line("  largest", angles ? kDegrees * pair.angles[pair.angles.size() - 1] : kNone);
  line("  Grassmann distance, rad", angles ? dytex::grassmann_distance(pair.angles) : kNone);
  line("windows' distance, dB", pair.windows.value_or(kNone));
  return out;
}

std::string matrix_table(const std::vector<std::string>& names, const cv::Mat& values,
                         dytex::Measure measure) {
  std::size_t first = 0;
  for (const auto& name : names) first = std::max(first, count_characters(name));
  std::string out = std::string(measure_caption(measure)) + "\n" + std::string(first, ' ');
  std::vector<std::size_t> widths;
  for (const auto& name : names) {
    widths.push_back(std::max<std::size_t>(13, count_characters(name) + 2));
    out += pad_left(name, widths.back());
  }
  out += "\n";
  for (int i = 0; i < values.rows; ++i) {
    out += pad_right(names[static_cast<std::size_t>(i)], first);
    for (int j = 0; j < values.cols; ++j)
      out += number_column(values.at<double>(i, j), static_cast<int>(widths[static_cast<std::size_t>(j)]));
    out += "\n";
  }
  return out;
}

std::string matrix_csv(const std::vector<std::string>& names, const cv::Mat& values) {
  std::string out = "model";
  for (const auto& name : names) out += "," + csv_field(name);
  out += "\n";
  for (int i = 0; i < values.rows; ++i) {
    out += csv_field(names[static_cast<std::size_t>(i)]);
    for (int j = 0; j < values.cols; ++j) {
      const double value = values.at<double>(i, j);
      out += "," + (std::isfinite(value) ? finite_json(value).dump() : std::string());
    }
    out += "\n";
  }
  return out;
}

cv::Mat draw_distances(const std::vector<std::string>& names, const cv::Mat& values, dytex::Measure measure) {
  return draw_heat_matrix({measure_caption(measure), names, values, measure == dytex::Measure::kl});
}

Json growth_json(const std::vector<Growth>& curves) {
  Json out = {{"format", "emberfold.texture_growth"}, {"version", 1}, {"unit", "nats"}};
  Json list = Json::array();
  for (const auto& curve : curves)
    list.push_back(
        {{"from", curve.from}, {"to", curve.to}, {"rate", curve.rate}, {"divergence", curve.values}});
  out["curves"] = std::move(list);
  return out;
}

cv::Mat draw_growth(const std::vector<Growth>& curves) {
  CurvePlot plot{"KL of the first model's clips from the second's", "frames", "nats", {}, false, false};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& curve : curves) {
    Curve drawn{curve.from + " from " + curve.to, {}, curve.values, false};
    for (std::size_t t = 1; t <= curve.values.size(); ++t) drawn.x.push_back(static_cast<double>(t));
    plot.curves.push_back(std::move(drawn));
    least = std::min(least, curve.values.back());
    most = std::max(most, curve.values.back());
  }
  plot.log_y = most > 20 * least && least > 0;
  return draw_curves(plot);
}

}  // namespace emberfold::apps
