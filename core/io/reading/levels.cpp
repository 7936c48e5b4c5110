// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/levels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/reading/value_range.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::io {

namespace {

// Share of the range: strokes within a smaller part are near the lowest contrast that is detected.
constexpr double kSmallPart = 1. / 8;
constexpr double kStray = 4;             // values are stray if they need a white this many times as large
constexpr double kBelowBlack = 1. / 32;  // of the largest value: floats this far below 0 are not rounding
constexpr double kLeastSteps = 16;       // in whole numbers: fewer show no shading, only rounding
constexpr double kMargin = 1. / 4;       // of the range that is spread, added at both ends for noise

/// Returns the largest number of the bits that the value needs, at least 8.
double all_ones(double value) {
  double white = 255;
  while (white < value) white = 2 * white + 1;
  return white;
}

double white_of(double max, int depth) {
  return depth == CV_32F && max <= 1 ? 1 : all_ones(max);
}

std::string text(double value) {
  return core::significant_text(value, 5);
}

std::string option_text(double low, double high) {
  return "--levels " + text(low) + ":" + text(high);
}

/// Describes what is doubtful about values that are read unchanged; empty where nothing is.
std::string doubt(const ValueRange& values, int depth, double white) {
  const std::string spread =
      values.high > values.low ? "; " + option_text(values.low, values.high) + " spreads them" : "";
  if (values.high - values.low < kSmallPart * white && values.max > values.min)
    return "nearly all of its values are between " + text(values.low) + " and " + text(values.high) +
           ", a small part of 0 to " + text(white) + spread;
  if (depth == CV_32F && white > 1)
    return "it holds floats from " + text(values.min) + " to " + text(values.max) + ", and " + text(white) +
           " is taken as white" + spread;
  const int bits = std::bit_width(static_cast<std::uint32_t>(white));
  if (depth == CV_16U && bits > 8 && bits % 2 != 0)
    return "its largest value is " + text(values.max) + ", so that it seems to use " + std::to_string(bits) +
           " of 16 bits, and " + text(white) + " is taken as white; --levels says it better";
  return {};
}

/// Automatic levels, and the warning about them.
struct AutoLevels {
  LevelRange range;
  std::string words;
};

/// Returns whether values from 0 on may hide content, so that a second pass is worth its time.
bool is_doubtful(const ValueRange& values, int depth) {
  const double white = white_of(values.max, depth);
  return values.low < 0 || values.high - values.low < kSmallPart * white ||
         white >= kStray * white_of(values.high, depth);
}

/// The range with a margin for noise, inside the values that occur; whole numbers for 16 bits.
LevelRange spread_range(const ValueRange& values, const SharedRange& shared, int depth) {
  const double margin = kMargin * (shared.max - shared.min);
  double black = std::max(values.min, shared.min - margin), white = std::min(values.max, shared.max + margin);
  if (depth == CV_16U) black = std::floor(black), white = std::ceil(white);
  return {black, white, true};
}

AutoLevels choose_levels(FrameDecoder& clip, const ValueRange& values) {
  const int depth = clip.info().depth;
  AutoLevels found{{0, white_of(values.max, depth)}, {}};
  LevelRange& range = found.range;
  if (values.max > values.min && is_doubtful(values, depth)) {
    SharedRange shared = measure_shared_range(clip);
    if (!shared.exists || shared.max <= shared.min) shared = {values.low, values.high, true};
    if (shared.max <= shared.min) shared = {values.min, values.max, true};
    const double shared_white = white_of(shared.max, depth);
    const bool has_stray = range.white + 1 >= kStray * (shared_white + (shared_white > 1 ? 1 : 0));
    if (has_stray) {
      range = {0, shared_white, true};
      found.words = "single pixels reach " + text(values.max) + ", all others at most " + text(shared.max) +
                    "; levels auto leaves them out, and " + text(shared_white) + " is white";
    }
    const bool has_negative = shared.min < 0 && values.low < 0 && -shared.min > kBelowBlack * shared.max;
    const bool has_steps = depth == CV_32F || shared.max - shared.min >= kLeastSteps;
    if (has_negative || (has_steps && shared.max - shared.min < kSmallPart * range.white)) {
      range = spread_range(values, shared, depth);
      found.words = "its values are between " + text(shared.min) + " and " + text(shared.max) +
                    (values.min < shared.min || values.max > shared.max ? " but for single pixels" : "") +
                    "; levels auto spreads these, as " + option_text(range.black, range.white) + " does";
    }
  }
  if (found.words.empty()) found.words = doubt(values, depth, range.white);
  return found;
}

std::string missing_words(const ValueRange& values) {
  const double share =
      100 * static_cast<double>(values.missing) / static_cast<double>(values.missing + values.count);
  return core::significant_text(share, 2) +
         " % of its values are no finite numbers (NaN or infinite); they are masked, no structure counts "
         "there";
}

}  // namespace

LevelRange find_levels(FrameDecoder& clip, const Levels& levels, const std::string& name,
                       const core::Warn& warn) {
  const int depth = clip.info().depth;
  const bool is_given = levels.kind == Levels::Kind::given;
  const LevelRange given{levels.low, levels.high, true};
  if (depth == CV_8U) return is_given ? given : LevelRange();
  if (depth == CV_16U && is_given) return given;
  if (depth == CV_16U && levels.kind == Levels::Kind::full) return {0, 65535};
  const ValueRange values = measure_range(clip);
  if (values.count == 0) throw core::InputError(name + " holds no finite number");
  if (warn && values.missing > 0) warn(name + ": " + missing_words(values));
  LevelRange range = given;
  if (levels.kind == Levels::Kind::full) {
    range = {values.min, values.max, true};
    if (values.max <= values.min)
      throw core::InputError("levels full is out of range: all values of " + name + " are " +
                             text(values.max));
  } else if (levels.kind == Levels::Kind::stored) {
    range = {0, white_of(values.max, depth)};
  } else if (levels.kind == Levels::Kind::used) {
    const AutoLevels found = choose_levels(clip, values);
    range = found.range;
    if (warn && !found.words.empty()) warn(name + ": " + found.words);
  }
  range.misses = values.missing > 0;
  return range;
}

cv::Mat apply_levels(const cv::Mat& frame, const LevelRange& range) {
  if (frame.empty() || !range.moves) return frame;
  const double size = range.white - range.black;
  cv::Mat moved;
  if (frame.depth() == CV_8U) {
    frame.convertTo(moved, CV_8U, 255 / size, -range.black * 255 / size);
    return moved;
  }
  frame.convertTo(moved, CV_32F, 1, -range.black);
  cv::max(moved, cv::Scalar::all(0), moved);
  cv::min(moved, cv::Scalar::all(size), moved);
  moved.convertTo(moved, frame.depth());
  return moved;
}

std::string outside_levels(const cv::Mat& frame, const Levels& levels) {
  if (levels.kind != Levels::Kind::given || frame.empty()) return {};
  cv::Mat values = frame.reshape(1);
  if (frame.depth() == CV_32F) cv::patchNaNs(values = values.clone(), levels.low);
  double min = 0, max = 0;
  cv::minMaxLoc(values, &min, &max);
  if (max > levels.low && min < levels.high) return {};
  return option_text(levels.low, levels.high) + " makes all of its first frame " +
         std::string(max <= levels.low ? "black" : "white") + ": the values there are " + text(min) + " to " +
         text(max);
}

}  // namespace emberfold::io
