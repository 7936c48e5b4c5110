// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/texture_fill.hpp"

#include <sstream>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/inpainting/fill.hpp"

namespace emberfold::sketch {

namespace {

void check(const char* who, const cv::Mat& observed, const Sketchable& drawn) {
  std::ostringstream message;
  if (observed.dims != 2 || observed.empty() || observed.depth() != CV_32F ||
      (observed.channels() != 1 && observed.channels() != 3))
    message << who << ": the observed frame is " << cv::typeToString(observed.type()) << ", " << observed.cols
            << " × " << observed.rows << "; allowed are CV_32FC1 and CV_32FC3 of at least 1 × 1";
  else if (drawn.levels.type() != observed.type() || drawn.levels.size() != observed.size())
    message << who << ": the patches are " << cv::typeToString(drawn.levels.type()) << ", "
            << drawn.levels.cols << " × " << drawn.levels.rows << "; they have to be as the frame is, "
            << cv::typeToString(observed.type()) << ", " << observed.cols << " × " << observed.rows;
  else if (drawn.mask.type() != CV_8UC1 || drawn.mask.size() != observed.size())
    message << who << ": the mask is " << cv::typeToString(drawn.mask.type()) << ", " << drawn.mask.cols
            << " × " << drawn.mask.rows << "; it has to be CV_8UC1 of the frame's size, " << observed.cols
            << " × " << observed.rows;
  else if (!cv::checkRange(observed))
    message << who << ": the observed frame holds a number that is not finite";
  if (!message.str().empty()) throw core::InputError(message.str());
}

}  // namespace

void NonsketchableFillOptions::validate() const {
  texture.validate();
  julesz.validate();
  efros_leung.validate();
  if (kind != FillMethod::diffusion && kind != FillMethod::julesz && kind != FillMethod::efros_leung)
    throw core::InputError("GroundOptions.kind is " + std::to_string(static_cast<int>(kind)) +
                           "; allowed are diffusion, julesz and efros_leung");
}

NonsketchableFillResult fill_nonsketchable(const cv::Mat& observed, const Sketchable& drawn,
                                           const NonsketchableFillOptions& options,
                                           const core::Context& context) {
  options.validate();
  check("fill_ground", observed, drawn);
  NonsketchableFillResult result;
  if (cv::countNonZero(drawn.mask) > 0) {
    auto filled = fill(drawn.levels, drawn.mask);
    result.levels = std::move(filled.levels);
    result.converged = filled.converged;
  } else {
    result.levels = cv::Mat(observed.size(), observed.type(), cv::mean(observed));
  }
  if (options.kind == FillMethod::diffusion) return result;
  TextureOptions of_texture = options.texture;
  of_texture.seed = options.seed;
  const auto regions = segment_texture(observed, drawn.mask, of_texture);
  result.regions = regions.count;
  if (options.kind == FillMethod::julesz) {
    JuleszOptions own = options.julesz;
    own.seed = options.seed;
    auto sample = julesz(result.levels, regions, own, context);
    result.levels = std::move(sample.levels);
    result.histogram_distance = sample.after;
  } else {
    EfrosLeungOptions own = options.efros_leung;
    own.seed = options.seed;
    auto grown = efros_leung(result.levels, observed, regions, own, context);
    result.levels = std::move(grown.levels);
  }
  return result;
}

}  // namespace emberfold::sketch
