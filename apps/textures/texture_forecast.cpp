// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_forecast.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/pictures/curve_plot.hpp"
#include "apps/pictures/png.hpp"
#include "core/clip/clip_range.hpp"
#include "core/io/clip_writer.hpp"
#include "core/text/format_number.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

double rms(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L2) /
         std::sqrt(static_cast<double>(a.total() * static_cast<std::size_t>(a.channels())));
}

std::vector<double> steps_of(std::size_t count) {
  std::vector<double> steps(count);
  for (std::size_t i = 0; i < count; ++i) steps[i] = static_cast<double>(i + 1);
  return steps;
}

cv::Mat draw_errors(const dytex::Forecast& forecast, const ForecastErrors& errors) {
  CurvePlot plot{"Forecast", "frames ahead", "RMS error per value, levels", {}};
  const auto add = [&](const char* name, const std::vector<double>& values, bool points) {
    if (!values.empty()) plot.curves.push_back({name, steps_of(values.size()), values, points});
  };
  add("expected", {forecast.error.begin(), forecast.error.end()}, forecast.error.size() == 1);
  add("forecast", errors.forecast, true);
  add("last frame again", errors.last_frame, errors.last_frame.size() == 1);
  add("mean", errors.mean, errors.mean.size() == 1);
  return draw_curves(plot);
}

}  // namespace

ForecastErrors forecast_errors(core::FrameSource& source, std::int64_t first,
                               const dytex::LinearDynamicTexture& texture, const dytex::Forecast& forecast,
                               const core::Context& context) {
  ForecastErrors errors;
  const auto& info = source.info();
  core::ClipRange part(source, first - 1, first + forecast.states.cols());
  const cv::Mat before = part.next();
  if (before.empty()) return errors;
  const cv::Mat last = core::to_levels(before, info);
  const cv::Mat mean = dytex::draw(texture, Eigen::VectorXd::Zero(texture.order()));
  for (Eigen::Index k = 0; k < forecast.states.cols(); ++k) {
    context.check();
    const cv::Mat frame = part.next();
    if (frame.empty()) break;
    const cv::Mat truth = core::to_levels(frame, info);
    errors.forecast.push_back(rms(dytex::draw(texture, forecast.states.col(k)), truth));
    errors.last_frame.push_back(rms(last, truth));
    errors.mean.push_back(rms(mean, truth));
  }
  return errors;
}

double write_forecast(io::OutputFolder& output, const dytex::LinearDynamicTexture& texture,
                      const dytex::Forecast& forecast, const ForecastErrors& errors,
                      const core::Context& context) {
  const auto& info = texture.info;
  const auto writer = io::create_video(output.staged("forecast.avi"), {info.width, info.height}, info.fps,
                                       info.channels == 3);
  const auto count = static_cast<double>(forecast.states.cols());
  for (Eigen::Index k = 0; k < forecast.states.cols(); ++k) {
    context.check();
    context.report("draw", static_cast<double>(k) / count);
    writer->write(core::to_bytes(dytex::draw(texture, forecast.states.col(k))));
  }
  writer->finish();
  const cv::Mat deviation = dytex::forecast_deviation(texture, forecast.covariances.back());
  double white = 0;
  cv::minMaxLoc(deviation.reshape(1), nullptr, &white);
  white = std::max(white, 1e-6);
  write_png(output, "deviation.png", core::to_bytes(deviation * (255 / white)));
  write_png(output, "forecast.png", draw_errors(forecast, errors));
  return white;
}

Json forecast_json(const dytex::Forecast& forecast, const ForecastErrors& errors) {
  Json steps = Json::array();
  for (std::size_t k = 0; k < static_cast<std::size_t>(forecast.error.size()); ++k) {
    Json step = {{"step", k + 1},
                 {"expected_error", core::round_to(forecast.error[static_cast<Eigen::Index>(k)], 6)}};
    if (k < errors.forecast.size()) {
      step["error"] = core::round_to(errors.forecast[k], 6);
      step["last_frame_error"] = core::round_to(errors.last_frame[k], 6);
      step["mean_error"] = core::round_to(errors.mean[k], 6);
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

cv::Mat draw_learning_curve(const dytex::LearningCurve& curve, int components) {
  std::vector<double> lengths, error, above, below, left_out;
  for (const auto& point : curve.points) {
    lengths.push_back(point.length);
    error.push_back(point.error);
    above.push_back(point.error + point.spread);
    below.push_back(std::max(point.error - point.spread, 0.0));
    left_out.push_back(point.left_out);
  }
  CurvePlot plot{"Error of the next frame, " + std::to_string(components) + " components",
                 "frames learned from",
                 "RMS error per value, levels",
                 {}};
  plot.curves.push_back({"error", lengths, error, true});
  if (curve.targets.size() > 1) {
    plot.curves.push_back({"one SD above", lengths, above, false});
    plot.curves.push_back({"one SD below", lengths, below, false});
  }
  plot.curves.push_back({"what the components leave out", lengths, left_out, false});
  plot.curves.push_back({"frame before again",
                         {lengths.front(), lengths.back()},
                         {curve.frame_before, curve.frame_before},
                         false});
  if (curve.critical) {
    const double x = *curve.critical;
    plot.curves.push_back(
        {"critical length: " + std::to_string(*curve.critical), {x, x}, {0, curve.plateau * 1.3}, false});
  }
  return draw_curves(plot);
}

Json learning_curve_json(const dytex::LearningCurve& curve) {
  Json points = Json::array();
  for (const auto& point : curve.points)
    points.push_back({{"length", point.length},
                      {"error", core::round_to(point.error, 6)},
                      {"spread", core::round_to(point.spread, 6)},
                      {"left_out", core::round_to(point.left_out, 6)}});
  return {{"targets", curve.targets},
          {"plateau", core::round_to(curve.plateau, 6)},
          {"critical_length", curve.critical ? Json(*curve.critical) : Json(nullptr)},
          {"frame_before_error", core::round_to(curve.frame_before, 6)},
          {"points", std::move(points)}};
}

}  // namespace emberfold::apps
