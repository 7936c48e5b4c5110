// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/staged_output.hpp"
#include "dytex/estimation/forecast.hpp"
#include "dytex/learning/learning_curve.hpp"

namespace emberfold::apps {

/// RMS errors per value, levels, by step: of the forecast, of repeating the last frame, of the model's mean.
struct ForecastErrors {
  std::vector<double> forecast, last_frame, mean;
};

/// Measures the errors from frame `first` of a source to its end or that of the forecast. Throws
/// core::Cancelled.
ForecastErrors forecast_errors(core::FrameSource& source, std::int64_t first,
                               const dytex::LinearDynamicTexture& texture, const dytex::Forecast& forecast,
                               const core::Context& context);

/// Writes forecast.avi (expected frames), deviation.png (standard deviations of the last one) and
/// forecast.png (errors by step). Returns the level shown as white in deviation.png; black is 0. Throws
/// core::Cancelled.
double write_forecast(io::OutputFolder& output, const dytex::LinearDynamicTexture& texture,
                      const dytex::Forecast& forecast, const ForecastErrors& errors,
                      const core::Context& context);

/// Writes "steps": expected error and, while the clip continues, the errors of forecast, last frame and mean.
nlohmann::ordered_json forecast_json(const dytex::Forecast& forecast, const ForecastErrors& errors);

/// Draws a learning curve with its spread, plateau and critical length, and writes it.
cv::Mat draw_learning_curve(const dytex::LearningCurve& curve, int components);
nlohmann::ordered_json learning_curve_json(const dytex::LearningCurve& curve);

}  // namespace emberfold::apps
