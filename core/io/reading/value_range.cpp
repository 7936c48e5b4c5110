// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/value_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/reading/missing_pixels.hpp"

namespace emberfold::io {

namespace {

constexpr double kOutliers = 1e-3;  // share of the values beyond `low` and `high`

/// Counts values; floats are sampled, and at most some millions kept.
class ValueCounter {
 public:
  explicit ValueCounter(bool whole) : count_(whole ? 65536 : 0) {}

  void add(const cv::Mat& frame) {
    const cv::Mat flat = frame.reshape(1);
    each_ = flat.total() < 4096 ? 1 : 61;  // coprime to usual widths, so that all columns are sampled
    for (int y = 0; y < flat.rows; ++y)
      if (count_.empty())
        add_row(flat.ptr<float>(y), flat.cols);
      else
        add_row(flat.ptr<std::uint16_t>(y), flat.cols);
  }

  ValueRange result() {
    if (!count_.empty()) {
      for (std::size_t value = 0; value < count_.size(); ++value) {
        if (count_[value] == 0) continue;
        if (range_.count == 0) range_.min = static_cast<double>(value);
        range_.max = static_cast<double>(value);
        range_.count += static_cast<std::int64_t>(count_[value]);
      }
      range_.low = quantile(kOutliers), range_.high = quantile(1 - kOutliers);
    } else if (!sample_.empty()) {
      std::ranges::sort(sample_);
      const auto end = static_cast<double>(sample_.size() - 1);
      range_.low = double{sample_[static_cast<std::size_t>(end * kOutliers)]};
      range_.high = double{sample_[static_cast<std::size_t>(std::ceil(end * (1 - kOutliers)))]};
    } else {
      range_.low = range_.min, range_.high = range_.max;
    }
    return range_;
  }

 private:
  void add_row(const std::uint16_t* row, int length) {
    for (int x = 0; x < length; ++x) ++count_[row[x]];
  }

  void add_row(const float* row, int length) {
    constexpr std::size_t kMost = std::size_t{1} << 22;
    for (int x = 0; x < length; ++x)
      if (std::isfinite(row[x]))
        extend(double{row[x]});
      else
        ++range_.missing;
    for (; next_ < length && sample_.size() < kMost; next_ += each_)
      if (std::isfinite(row[next_])) sample_.push_back(row[next_]);
    next_ = std::max(0, next_ - length);
  }

  void extend(double value) {
    if (range_.count++ == 0) range_.min = range_.max = value;
    range_.min = std::min(range_.min, value), range_.max = std::max(range_.max, value);
  }

  [[nodiscard]] double quantile(double share) const {
    std::uint64_t below = 0;
    for (std::size_t value = 0; value < count_.size(); ++value) {
      below += count_[value];
      if (static_cast<double>(below) >= share * static_cast<double>(range_.count))
        return static_cast<double>(value);
    }
    return 65535;
  }

  ValueRange range_;
  std::vector<std::uint64_t> count_;
  std::vector<float> sample_;
  int each_ = 1, next_ = 0;
};

/// The four lines of three pixels through a pixel.
std::array<cv::Mat1b, 4> lines_of_three() {
  return {cv::Mat1b((cv::Mat1b(3, 3) << 0, 0, 0, 1, 1, 1, 0, 0, 0)),
          cv::Mat1b((cv::Mat1b(3, 3) << 0, 1, 0, 0, 1, 0, 0, 1, 0)),
          cv::Mat1b((cv::Mat1b(3, 3) << 1, 0, 0, 0, 1, 0, 0, 0, 1)),
          cv::Mat1b((cv::Mat1b(3, 3) << 0, 0, 1, 0, 1, 0, 1, 0, 0))};
}

/// Widens the range by one frame of finite values.
void widen(SharedRange& range, const cv::Mat& frame) {
  if (frame.rows < 3 || frame.cols < 3) return;
  for (const auto& line : lines_of_three()) {
    // Only where the whole line is inside the frame.
    const int across = line(0, 1) != 0 ? 0 : 1, down = line(1, 0) != 0 ? 0 : 1;
    const cv::Rect inner(across, down, frame.cols - 2 * across, frame.rows - 2 * down);
    cv::Mat all_reach, none_below;
    cv::erode(frame, all_reach, line);
    cv::dilate(frame, none_below, line);
    double low = 0, high = 0;
    cv::minMaxLoc(all_reach(inner).clone().reshape(1), nullptr, &high);
    cv::minMaxLoc(none_below(inner).clone().reshape(1), &low, nullptr);
    range.max = range.exists ? std::max(range.max, high) : high;
    range.min = range.exists ? std::min(range.min, low) : low;
    range.exists = true;
  }
}

}  // namespace

ValueRange measure_range(FrameDecoder& clip) {
  ValueCounter counter(clip.info().depth == CV_16U);
  clip.rewind();
  for (cv::Mat frame = clip.next(); !frame.empty(); frame = clip.next()) counter.add(frame);
  clip.rewind();
  return counter.result();
}

SharedRange measure_shared_range(FrameDecoder& clip) {
  SharedRange range;
  clip.rewind();
  for (cv::Mat frame = clip.next(); !frame.empty(); frame = clip.next()) {
    if (frame.depth() == CV_32F) fill_missing(frame);
    widen(range, frame);
  }
  clip.rewind();
  return range;
}

}  // namespace emberfold::io
