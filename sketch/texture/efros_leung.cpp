// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/efros_leung.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kMeanBins = 32;       // of places by the mean around them
constexpr int kReportEvery = 2048;  // pixels

void check(const cv::Mat& start, const cv::Mat& observed, const TextureRegions& regions) {
  std::ostringstream message;
  double highest = 0;
  if (start.dims != 2 || start.empty() || start.depth() != CV_32F ||
      (start.channels() != 1 && start.channels() != 3))
    message << "efros_leung: levels are " << cv::typeToString(start.type()) << ", " << start.cols << " × "
            << start.rows << "; allowed are CV_32FC1 and CV_32FC3 of at least 1 × 1";
  else if (observed.type() != start.type() || observed.size() != start.size())
    message << "efros_leung: the observed frame is " << cv::typeToString(observed.type()) << ", "
            << observed.cols << " × " << observed.rows << "; it has to be as the start is, "
            << cv::typeToString(start.type()) << ", " << start.cols << " × " << start.rows;
  else if (regions.label.dims != 2 || regions.label.type() != CV_8UC1 || regions.label.size() != start.size())
    message << "efros_leung: the labels are " << cv::typeToString(regions.label.type()) << ", "
            << regions.label.cols << " × " << regions.label.rows
            << "; they have to be CV_8UC1 of the levels' size, " << start.cols << " × " << start.rows;
  else if (!cv::checkRange(start) || !cv::checkRange(observed))
    message << "efros_leung: the levels hold a number that is not finite";
  else if (cv::minMaxLoc(regions.label, nullptr, &highest); highest > regions.count)
    message << "efros_leung: there are labels up to " << highest << " for " << regions.count << " regions";
  if (!message.str().empty()) throw core::InputError(message.str());
}

/// The free pixels in the order they are drawn: always one with the most known pixels among its eight
/// neighbours and, of equals, the one that came to be so first.
class Front {
 public:
  explicit Front(const cv::Mat& known) : known_(known), counts_(known.size(), CV_8U, cv::Scalar(0)) {
    for (int y = 0; y < known.rows; ++y)
      for (int x = 0; x < known.cols; ++x)
        if (known.at<std::uint8_t>(y, x) != 0) spread({x, y});
  }
  /// False when no unknown pixel has a known neighbour.
  bool next(cv::Point& pixel) {
    for (std::size_t count = queues_.size(); count-- > 0;)
      while (heads_[count] < queues_[count].size()) {
        pixel = queues_[count][heads_[count]++];
        // Stale: drawn, or waiting with more neighbours.
        if (known_.at<std::uint8_t>(pixel) == 0 && counts_.at<std::uint8_t>(pixel) == count) return true;
      }
    return false;
  }
  void mark_drawn(cv::Point pixel) {
    known_.at<std::uint8_t>(pixel) = 255;
    spread(pixel);
  }
  [[nodiscard]] bool is_known(int y, int x) const { return known_.at<std::uint8_t>(y, x) != 0; }

 private:
  void spread(cv::Point pixel) {
    for (int y = std::max(0, pixel.y - 1); y <= std::min(known_.rows - 1, pixel.y + 1); ++y)
      for (int x = std::max(0, pixel.x - 1); x <= std::min(known_.cols - 1, pixel.x + 1); ++x) {
        if (known_.at<std::uint8_t>(y, x) != 0) continue;
        const auto count = ++counts_.at<std::uint8_t>(y, x);
        queues_[count].emplace_back(x, y);
      }
  }

  cv::Mat known_, counts_;
  std::array<std::vector<cv::Point>, 9> queues_;
  std::array<std::size_t, 9> heads_{};
};

/// Places of one region, by the mean around them.
struct Places {
  std::vector<cv::Point> all;  ///< ascending mean
  std::vector<float> means;
};

class Grower {
 public:
  Grower(const cv::Mat& start, const cv::Mat& observed, const TextureRegions& regions,
         const EfrosLeungOptions& options);
  bool next(cv::Point& pixel) { return front_.next(pixel); }
  void draw(cv::Point pixel);
  void plant();
  [[nodiscard]] EfrosLeungResult result() const { return {canvas_(inner_).clone(), source_.clone()}; }

 private:
  struct Candidate {
    cv::Point place;
    double cost;
  };
  [[nodiscard]] bool usable(cv::Point place, cv::Point pixel) const;
  void set_target(cv::Point pixel);
  [[nodiscard]] double cost(cv::Point place, double limit) const;
  void look_at(cv::Point place, cv::Point pixel);
  void look_around(cv::Point pixel);
  void look_far(cv::Point pixel, core::Rng& rng);
  void copy(cv::Point place, cv::Point pixel);

  const TextureRegions& regions_;
  const EfrosLeungOptions& options_;
  int radius_, channels_;
  cv::Rect inner_;             // of the frame in what has a margin
  cv::Mat canvas_, observed_;  // both with a margin of the window's radius
  cv::Mat known_;              // with that margin too: 0 beyond the frame
  cv::Mat source_;
  cv::Mat smooth_;              // luma around each observed pixel
  std::vector<Places> places_;  // [0] all that is free, then by label
  Front front_;
  std::vector<float> bell_;
  // Current pixel: the levels of its window and their weights.
  std::vector<float> target_, weights_;
  std::vector<Candidate> candidates_;
  double best_ = 0;
};

cv::Mat padded(const cv::Mat& image, int margin, int border, const cv::Scalar& value = {}) {
  cv::Mat result;
  cv::copyMakeBorder(image, result, margin, margin, margin, margin, border, value);
  return result;
}

cv::Mat one_channel(const cv::Mat& levels) {
  if (levels.channels() == 1) return levels;
  cv::Mat sum;
  cv::transform(levels, sum, cv::Matx13f(1.0F / 3, 1.0F / 3, 1.0F / 3));
  return sum;
}

Grower::Grower(const cv::Mat& start, const cv::Mat& observed, const TextureRegions& regions,
               const EfrosLeungOptions& options)
    : regions_(regions),
      options_(options),
      radius_(options.window / 2),
      channels_(start.channels()),
      inner_(radius_, radius_, start.cols, start.rows),
      canvas_(padded(start, radius_, cv::BORDER_REPLICATE)),
      observed_(padded(observed, radius_, cv::BORDER_REFLECT)),
      source_(start.size(), CV_32SC2, cv::Scalar::all(-1)),
      front_(cv::Mat(regions.label == 0)) {
  known_ = padded(regions.label == 0, radius_, cv::BORDER_CONSTANT);
  cv::boxFilter(one_channel(observed), smooth_, CV_32F, {options.window, options.window});
  places_.resize(static_cast<std::size_t>(regions.count) + 1);
  for (int y = 0; y < start.rows; ++y)
    for (int x = 0; x < start.cols; ++x)
      if (const auto label = regions.label.at<std::uint8_t>(y, x); label != 0)
        for (const std::size_t list : {std::size_t{0}, std::size_t{label}})
          places_[list].all.emplace_back(x, y);
  for (Places& places : places_) {
    std::ranges::stable_sort(places.all, {}, [&](cv::Point p) { return smooth_.at<float>(p); });
    for (const cv::Point p : places.all) places.means.push_back(smooth_.at<float>(p));
  }
  const double sd = options.window / 6.4;  // Efros and Leung's
  for (int dy = -radius_; dy <= radius_; ++dy)
    for (int dx = -radius_; dx <= radius_; ++dx)
      bell_.push_back(static_cast<float>(std::exp(-(dx * dx + dy * dy) / (2 * sd * sd))));
}

/// Not from so near that the window would find itself.
bool Grower::usable(cv::Point place, cv::Point pixel) const {
  const cv::Size size = regions_.label.size();
  return place.x >= 0 && place.y >= 0 && place.x < size.width && place.y < size.height &&
         regions_.label.at<std::uint8_t>(place) == regions_.label.at<std::uint8_t>(pixel) &&
         std::max(std::abs(place.x - pixel.x), std::abs(place.y - pixel.y)) > radius_;
}

void Grower::set_target(cv::Point pixel) {
  const auto guidance = static_cast<float>(options_.guidance);
  target_.clear();
  weights_.clear();
  std::size_t i = 0;
  for (int dy = 0; dy < options_.window; ++dy)
    for (int dx = 0; dx < options_.window; ++dx, ++i) {
      const cv::Point at(pixel.x + dx, pixel.y + dy);
      const bool beyond = !inner_.contains(at);
      const float factor = beyond ? 0.0F : known_.at<std::uint8_t>(at) != 0 ? 1.0F : guidance;
      for (int c = 0; c < channels_; ++c) {
        target_.push_back(canvas_.ptr<float>(at.y)[at.x * channels_ + c]);
        weights_.push_back(bell_[i] * factor);
      }
    }
}

/// Weighted squared difference of a place's window from the target; what is beyond `limit` may be less than
/// it is.
double Grower::cost(cv::Point place, double limit) const {
  double sum = 0;
  const int row = options_.window * channels_;
  const float *target = target_.data(), *weight = weights_.data();
  for (int dy = 0; dy < options_.window && sum <= limit; ++dy, target += row, weight += row) {
    const float* levels = observed_.ptr<float>(place.y + dy) + place.x * channels_;
    float part = 0;
    for (int i = 0; i < row; ++i) {
      const float d = levels[i] - target[i];
      part += weight[i] * d * d;
    }
    sum += static_cast<double>(part);
  }
  return sum;
}

void Grower::look_at(cv::Point place, cv::Point pixel) {
  if (!usable(place, pixel)) return;
  for (const auto& other : candidates_)
    if (other.place == place) return;
  const double limit = best_ * (1 + options_.tolerance);
  const double own = cost(place, limit);
  if (own > limit) return;
  best_ = std::min(best_, own);
  candidates_.push_back({place, own});
}

/// Continues the copies of the neighbours to this pixel.
void Grower::look_around(cv::Point pixel) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point other(pixel.x + dx, pixel.y + dy);
      if (other.x < 0 || other.y < 0 || other.x >= source_.cols || other.y >= source_.rows) continue;
      const auto from = source_.at<cv::Vec2i>(other);
      if (from[0] >= 0) look_at({from[0] - dx, from[1] - dy}, pixel);
    }
}

void Grower::look_far(cv::Point pixel, core::Rng& rng) {
  const Places& places = places_[regions_.label.at<std::uint8_t>(pixel)];
  const auto count = static_cast<std::uint32_t>(places.all.size());
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < target_.size(); ++i) {
    sum += static_cast<double>(weights_[i] * target_[i]);
    weight += static_cast<double>(weights_[i]);
  }
  const auto mean = static_cast<float>(weight > 0 ? sum / weight : 0);
  const auto near =
      static_cast<std::uint32_t>(std::ranges::lower_bound(places.means, mean) - places.means.begin());
  const std::uint32_t span = std::max(1U, count / kMeanBins);
  const std::uint32_t first = std::min(near - std::min(near, span / 2), count - std::min(count, span));
  for (int i = 0; i < options_.candidates; ++i) {
    const std::uint32_t which =
        i % 2 == 0 ? first + rng.below(std::min(span, count - first)) : rng.below(count);
    look_at(places.all[which], pixel);
  }
}

void Grower::copy(cv::Point place, cv::Point pixel) {
  const auto* from = observed_.ptr<float>(place.y + radius_) + (place.x + radius_) * channels_;
  std::copy_n(from, channels_, canvas_.ptr<float>(pixel.y + radius_) + (pixel.x + radius_) * channels_);
  known_.at<std::uint8_t>(pixel.y + radius_, pixel.x + radius_) = 255;
  source_.at<cv::Vec2i>(pixel) = {place.x, place.y};
  front_.mark_drawn(pixel);
}

void Grower::draw(cv::Point pixel) {
  core::Rng rng(options_.seed, {static_cast<std::uint32_t>(pixel.y * source_.cols + pixel.x)});
  candidates_.clear();
  best_ = std::numeric_limits<double>::max() / 4;
  set_target(pixel);
  look_around(pixel);
  look_far(pixel, rng);
  if (candidates_.empty()) {  // the region is no wider than a window
    const auto& all = places_[0].all;
    cv::Point place = pixel;
    for (int i = 0; i < options_.candidates && place == pixel; ++i) {
      const cv::Point other = all[rng.below(static_cast<std::uint32_t>(all.size()))];
      if (std::max(std::abs(other.x - pixel.x), std::abs(other.y - pixel.y)) > radius_) place = other;
    }
    copy(place, pixel);
    return;
  }
  std::erase_if(candidates_, [&](const Candidate& c) { return c.cost > best_ * (1 + options_.tolerance); });
  copy(candidates_[rng.below(static_cast<std::uint32_t>(candidates_.size()))].place, pixel);
}

/// The first pixels where nothing is held: 3 × 3 of them, from anywhere in the region of the middle one.
void Grower::plant() {
  const cv::Point middle(source_.cols / 2, source_.rows / 2);
  core::Rng rng(options_.seed, {0, 1});
  const auto& all = places_[regions_.label.at<std::uint8_t>(middle)].all;
  const cv::Point from = all[rng.below(static_cast<std::uint32_t>(all.size()))];
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point place(from.x + dx, from.y + dy), pixel(middle.x + dx, middle.y + dy);
      const cv::Rect frame(cv::Point(), source_.size());
      if (frame.contains(place) && frame.contains(pixel)) copy(place, pixel);
    }
}

}  // namespace

void EfrosLeungOptions::validate() const {
  core::check_odd("EfrosLeungOptions.window", window, 3, 31);
  core::check_at_least("EfrosLeungOptions.tolerance", tolerance, 0);
  core::check_range("EfrosLeungOptions.candidates", candidates, 1, 100000);
  core::check_range("EfrosLeungOptions.guidance", guidance, 0, 1);
}

EfrosLeungResult efros_leung(const cv::Mat& start, const cv::Mat& observed, const TextureRegions& regions,
                             const EfrosLeungOptions& options, const core::Context& context) {
  options.validate();
  check(start, observed, regions);
  const int free = cv::countNonZero(regions.label);
  Grower grower(start, observed, regions, options);
  if (free == start.rows * start.cols) grower.plant();
  cv::Point pixel;
  for (int drawn = 0; grower.next(pixel); ++drawn) {
    if (drawn % kReportEvery == 0) {
      context.check();
      context.report("efros-leung", double(drawn) / free);
    }
    grower.draw(pixel);
  }
  return grower.result();
}

}  // namespace emberfold::sketch
