// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/levels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::io {

namespace {

constexpr double kOutliers = 1e-3;  // share of the values at either end that may be stray
constexpr double kSmallPart =
    1. / 8;  // of the range: strokes in it are near the least contrast that is found

/// What is known of a clip's values once all were seen.
struct Values {
  double least = 0, most = 0;
  double low = 0, high = 0;  ///< without outliers
};

/// Counts values; those of floats are sampled, and at most some millions kept.
class ValueCounter {
 public:
  explicit ValueCounter(bool whole) : count_(whole ? 65536 : 0) {}

  void add(const cv::Mat& frame) {
    const cv::Mat flat = frame.reshape(1);
    each_ = flat.total() < 4096 ? 1 : 61;  // prime to usual widths, so that columns take turns
    double least = 0, most = 0;
    cv::minMaxLoc(flat, &least, &most);
    values_.least = is_first_ ? least : std::min(values_.least, least);
    values_.most = is_first_ ? most : std::max(values_.most, most);
    is_first_ = false;
    for (int y = 0; y < flat.rows; ++y)
      if (count_.empty())
        sample(flat.ptr<float>(y), flat.cols);
      else
        for (int x = 0; x < flat.cols; ++x) ++count_[flat.ptr<std::uint16_t>(y)[x]];
  }

  Values result() {
    if (count_.empty()) {
      std::ranges::sort(sample_);
      const auto end = static_cast<double>(sample_.size() - 1);
      values_.low = double{sample_[static_cast<std::size_t>(end * kOutliers)]};
      values_.high = double{sample_[static_cast<std::size_t>(std::ceil(end * (1 - kOutliers)))]};
      return values_;
    }
    values_.low = quantile(kOutliers), values_.high = quantile(1 - kOutliers);
    return values_;
  }

 private:
  void sample(const float* row, int length) {
    constexpr std::size_t kMost = std::size_t{1} << 22;
    for (; next_ < length && sample_.size() < kMost; next_ += each_) sample_.push_back(row[next_]);
    next_ = std::max(0, next_ - length);
  }

  [[nodiscard]] double quantile(double share) const {
    std::uint64_t all = 0, below = 0;
    for (const auto n : count_) all += n;
    for (std::size_t value = 0; value < count_.size(); ++value) {
      below += count_[value];
      if (static_cast<double>(below) >= share * static_cast<double>(all)) return static_cast<double>(value);
    }
    return 65535;
  }

  Values values_;
  bool is_first_ = true;
  std::vector<std::uint64_t> count_;
  std::vector<float> sample_;
  int each_ = 1, next_ = 0;
};

/// The largest number in as many bits as the value needs, at least 8.
double all_ones(double value) {
  double white = 255;
  while (white < value) white = 2 * white + 1;
  return white;
}

std::string doubt(const Values& values, int depth, double white) {
  const auto text = [](double value) { return core::significant_text(value, 5); };
  const std::string spread =
      values.high > values.low ? "; --levels " + text(values.low) + ":" + text(values.high) + " spreads them"
                               : "";
  if (values.high - values.low < kSmallPart * white && values.most > values.least)
    return "nearly all of its values lie between " + text(values.low) + " and " + text(values.high) +
           ", a small part of 0 to " + text(white) + spread;
  if (depth == CV_32F && white > 1)
    return "it holds floats from " + text(values.least) + " to " + text(values.most) + ", and " +
           text(white) + " is taken as white" + spread;
  const int bits = std::bit_width(static_cast<std::uint32_t>(white));
  if (depth == CV_16U && bits > 8 && bits % 2 != 0)
    return "its largest value is " + text(values.most) + ", so that it seems to use " + std::to_string(bits) +
           " of 16 bits, and " + text(white) + " is taken as white; --levels says it better";
  return {};
}

}  // namespace

LevelRange find_levels(FrameDecoder& clip, const Levels& levels, const std::string& name,
                       const core::Warn& warn) {
  if (levels.kind == Levels::Kind::given) return {levels.low, levels.high};
  const int depth = clip.info().depth;
  if (depth == CV_8U) return {};
  if (depth == CV_16U && levels.kind == Levels::Kind::full) return {0, 65535};
  ValueCounter counter(depth == CV_16U);
  clip.rewind();
  for (cv::Mat frame = clip.next(); !frame.empty(); frame = clip.next()) counter.add(frame);
  clip.rewind();
  const Values values = counter.result();
  if (levels.kind == Levels::Kind::full) {
    if (values.most > values.least) return {values.least, values.most};
    throw core::InputError("levels full is out of range: all values of " + name + " are " +
                           core::significant_text(values.most, 5));
  }
  const LevelRange range{0, depth == CV_32F && values.most <= 1 ? 1 : all_ones(values.most)};
  const std::string words = doubt(values, depth, range.white);
  if (warn && !words.empty()) warn(name + ": " + words);
  return range;
}

cv::Mat apply_levels(const cv::Mat& frame, const Levels& levels, const LevelRange& range) {
  if (frame.empty() || levels.kind == Levels::Kind::used) return frame;
  const double size = range.white - range.black;
  cv::Mat moved;
  if (frame.depth() == CV_8U) {
    if (levels.kind == Levels::Kind::full) return frame;
    frame.convertTo(moved, CV_8U, 255 / size, -range.black * 255 / size);
    return moved;
  }
  frame.convertTo(moved, CV_32F, 1, -range.black);
  cv::max(moved, cv::Scalar::all(0), moved);
  cv::min(moved, cv::Scalar::all(size), moved);
  moved.convertTo(moved, frame.depth());
  return moved;
}

}  // namespace emberfold::io
