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

/// RMS errors per value, levels, of the frames that were foretold and then came: of the forecast, of the last
/// frame before it shown again, and of the model's mean.
struct ForecastErrors {
  std::vector<double> forecast, last_frame, mean;
};

/// Reads on from frame `first` of a source, as far as it goes and the forecast reaches. Throws
/// core::Cancelled.
ForecastErrors forecast_errors(core::FrameSource& source, std::int64_t first,
                               const dytex::LinearDynamicTexture& texture, const dytex::Forecast& forecast,
                               const core::Context& context);

/// Writes forecast.avi (the expected frames), deviation.png (how far values of the last one may miss, black:
/// 0, white: `white` levels, which is returned), forecast.png (the errors against the step). Throws
/// core::Cancelled.
double write_forecast(io::OutputFolder& output, const dytex::LinearDynamicTexture& texture,
                      const dytex::Forecast& forecast, const ForecastErrors& errors,
                      const core::Context& context);

/// "steps": expected error, and where the clip went on those of forecast, last frame and mean.
nlohmann::ordered_json forecast_json(const dytex::Forecast& forecast, const ForecastErrors& errors);

/// The learning curve with its spread, plateau and critical length.
cv::Mat draw_learning_curve(const dytex::LearningCurve& curve, int components);
nlohmann::ordered_json learning_curve_json(const dytex::LearningCurve& curve);

}  // namespace emberfold::apps
