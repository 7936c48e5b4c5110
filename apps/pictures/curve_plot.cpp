// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/curve_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

const cv::Scalar kFaint(226, 222, 218);
// Blue, vermilion, green, purple, orange, sky, black: distinguishable with colour blindness (Okabe, Ito
// 2008).
const std::array<cv::Scalar, 7> kColours = {
    cv::Scalar(178, 114, 0), cv::Scalar(0, 94, 213),   cv::Scalar(115, 158, 0), cv::Scalar(167, 121, 204),
    cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86), cv::Scalar(60, 60, 60)};
const cv::Rect kBox(86, 44, 900 - 86 - 24, 540 - 44 - 62);

// Maps the values of one axis to 0…1 and chooses its ticks.
class Axis {
 public:
  explicit Axis(bool log) : log_(log) {}

  void take(double value) {
    if (!shows(value)) return;
    low_ = std::min(low_, on_scale(value));
    high_ = std::max(high_, on_scale(value));
  }
  // Linear axes of quantities begin at 0.
  void settle(bool from_zero) {
    if (low_ > high_) low_ = 0, high_ = 1;
    if (!log_ && from_zero) low_ = std::min(low_, 0.0);
    const double margin = 0.04 * std::max(high_ - low_, log_ ? 0.5 : 1e-12 + 1e-3 * std::abs(high_));
    high_ += margin;
    if (log_ || low_ != 0) low_ -= margin;
  }
  [[nodiscard]] bool shows(double value) const { return std::isfinite(value) && (!log_ || value > 0); }
  [[nodiscard]] double place(double value) const { return (on_scale(value) - low_) / (high_ - low_); }
  [[nodiscard]] std::vector<double> ticks() const {
    if (log_ && high_ - low_ > 1.5) return decades();
    return log_ ? round_values(std::pow(10, low_), std::pow(10, high_)) : round_values(low_, high_);
  }

 private:
  [[nodiscard]] double on_scale(double value) const { return log_ ? std::log10(value) : value; }
  [[nodiscard]] std::vector<double> decades() const {
    std::vector<double> values;
    const double step = std::max(1.0, std::ceil((high_ - low_) / 8));
    for (double e = std::ceil(low_); e <= high_; e += step) values.push_back(std::pow(10, e));
    return values;
  }
  static std::vector<double> round_values(double low, double high) {
    const double rough = (high - low) / 6, power = std::pow(10, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double factor : {1.0, 2.0, 5.0})
      if (factor * power >= rough) {
        step = factor * power;
        break;
      }
    std::vector<double> values;
    for (double i = std::ceil(low / step); i * step <= high; i += 1)
      values.push_back(i * step + 0.0);  // no −0
    return values;
  }

  bool log_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

cv::Point2d place(const Axis& x, const Axis& y, double px, double py) {
  return {kBox.x + x.place(px) * kBox.width, kBox.y + (1 - y.place(py)) * kBox.height};
}

void draw_axes(cv::Mat& picture, const CurvePlot& plot, const Axis& x, const Axis& y) {
  const int bottom = kBox.y + kBox.height;
  for (const double value : x.ticks()) {
    const int at = cvRound(kBox.x + x.place(value) * kBox.width);
    cv::line(picture, {at, kBox.y}, {at, bottom}, kFaint);
    const std::string number = core::significant_text(value, 4);
    write_text(picture, number, {at - text_width(number) / 2, bottom + 18});
  }
  for (const double value : y.ticks()) {
    const int at = cvRound(kBox.y + (1 - y.place(value)) * kBox.height);
    cv::line(picture, {kBox.x, at}, {kBox.x + kBox.width, at}, kFaint);
    const std::string number = core::significant_text(value, 4);
    write_text(picture, number, {kBox.x - 8 - text_width(number), at + 4});
  }
  cv::rectangle(picture, kBox, kInk);
  write_text(picture, plot.title, {kBox.x, 26}, 0.55);
  write_text(picture, plot.x_label, {kBox.x + (kBox.width - text_width(plot.x_label)) / 2, bottom + 44});
  cv::Mat label(18, std::max(1, text_width(plot.y_label)), CV_8UC3, kPaper), upright;
  write_text(label, plot.y_label, {0, 13});
  cv::rotate(label, upright, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect all(0, 0, picture.cols, picture.rows);
  const cv::Rect there(8, kBox.y + std::max(0, (kBox.height - upright.rows) / 2), upright.cols, upright.rows);
  upright(cv::Rect({0, 0}, (there & all).size())).copyTo(picture(there & all));
}

void draw_curve(cv::Mat& picture, const Curve& curve, const cv::Scalar& colour, const Axis& x,
                const Axis& y) {
  constexpr int kShift = 4;
  std::vector<cv::Point> run;
  const auto end_run = [&] {
    cv::polylines(picture, run, false, colour, 2, cv::LINE_AA, kShift);
    if (curve.points)
      for (const auto& point : run)
        cv::circle(picture, point, 4 << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
    run.clear();
  };
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) {
      end_run();
      continue;
    }
    const cv::Point2d at = place(x, y, curve.x[i], curve.y[i]);
    run.emplace_back(cvRound(at.x * (1 << kShift)), cvRound(at.y * (1 << kShift)));
  }
  end_run();
}

const cv::Scalar& colour_of(const CurvePlot& plot, std::size_t i) {
  const int own = plot.curves[i].colour;
  return kColours[(own < 0 ? i : static_cast<std::size_t>(own)) % kColours.size()];
}

// Chooses the corner where the legend covers the fewest pixels of curves (CV_8U, not 0 on a curve).
cv::Rect names_place(cv::Size size, const cv::Mat& curves) {
  constexpr int kMargin = 8;
  const int left = kBox.x + kMargin, right = kBox.x + kBox.width - kMargin - size.width,
            top = kBox.y + kMargin, bottom = kBox.y + kBox.height - kMargin - size.height;
  cv::Rect best;
  int least = std::numeric_limits<int>::max();
  for (const cv::Point corner : {cv::Point(right, bottom), {right, top}, {left, bottom}, {left, top}}) {
    const cv::Rect place = cv::Rect(corner, size) & kBox;
    const int hidden = place.empty() ? 0 : cv::countNonZero(curves(place));
    if (hidden < least) least = hidden, best = place;
  }
  return best;
}

void draw_names(cv::Mat& picture, const CurvePlot& plot, const cv::Mat& curves) {
  int width = 0;
  for (const auto& curve : plot.curves) width = std::max(width, text_width(curve.name));
  const auto place = names_place({width + 44, 8 + 20 * static_cast<int>(plot.curves.size())}, curves);
  if (place.empty()) return;
  cv::rectangle(picture, place, kPaper, cv::FILLED);
  cv::rectangle(picture, place, kFaint);
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    const int y = place.y + 14 + 20 * static_cast<int>(i);
    cv::line(picture, {place.x + 8, y}, {place.x + 30, y}, colour_of(plot, i), 2, cv::LINE_AA);
    write_text(picture, plot.curves[i].name, {place.x + 38, y + 4});
  }
}

}  // namespace

cv::Mat draw_curves(const CurvePlot& plot) {
  cv::Mat picture(540, 900, CV_8UC3, kPaper);
  Axis x(plot.log_x), y(plot.log_y);
  for (const auto& curve : plot.curves)
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
      if (!x.shows(curve.x[i]) || !y.shows(curve.y[i])) continue;
      x.take(curve.x[i]);
      y.take(curve.y[i]);
    }
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& curve : plot.curves)
    for (const double value : curve.y)
      if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  x.settle(false);
  y.settle(least < most / 3);
  draw_axes(picture, plot, x, y);
  const cv::Mat axes = picture.clone();
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    draw_curve(picture, plot.curves[i], colour_of(plot, i), x, y);
  cv::Mat drawn_over;
  cv::absdiff(picture, axes, drawn_over);
  cv::cvtColor(drawn_over, drawn_over, cv::COLOR_BGR2GRAY);
  draw_names(picture, plot, drawn_over);
  return picture;
}

}  // namespace emberfold::apps
