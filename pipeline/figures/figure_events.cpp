// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "pipeline/figures/figure_changes.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kNearFrames = 6;  // to either side of a change
constexpr double kNear = 15;            // px from a contact, or two widths of the part
constexpr double kLeftShare = 0.15;     // of a figure's pixels; where fewer are left it is not there
constexpr int kLeastThere = 12;         // px²

/// Where a place is in some frame.
struct Place {
  std::size_t frame = 0;
  cv::Point2d at;
};

/// Returns a place in its frame and in the next ones, or in the ones before, kNearFrames in all.
std::vector<Place> followed(Place place, bool forwards, const FigureGround& ground) {
  std::vector<Place> places{place};
  while (places.size() < kNearFrames && (forwards ? place.frame + 1 < ground.frames() : place.frame > 0)) {
    const FigureMotion& motion = forwards ? ground.to[place.frame] : ground.from[place.frame];
    place.at = moved(motion, ground.view.size, place.at.x, place.at.y);
    place.frame += forwards ? 1 : -1;
    places.push_back(place);
  }
  return places;
}

using Pixels = std::vector<cv::Point>;

cv::Point shifted(const cv::Point& pixel, const cv::Point2d& shift) {
  return {cvRound(pixel.x + shift.x), cvRound(pixel.y + shift.y)};
}
/// Returns the square of pixels within `reach` of a place, as far as it lies in a frame.
cv::Rect square_about(const cv::Point2d& at, int reach, const cv::Size& frame) {
  return cv::Rect(cvRound(at.x) - reach, cvRound(at.y) - reach, 2 * reach + 1, 2 * reach + 1) &
         cv::Rect({0, 0}, frame);
}

/// Returns the farther half of pixels given with their distances.
Pixels farther_half(const std::vector<std::pair<double, cv::Point>>& pixels) {
  double farthest = 0;
  for (const auto& [apart, pixel] : pixels) farthest = std::max(farthest, apart);
  Pixels half;
  for (const auto& [apart, pixel] : pixels)
    if (apart >= farthest / 2) half.push_back(pixel);
  return half;
}

/// The contact of a part with the other parts of its whole, in the frame where they are apart.
struct Contact {
  cv::Point2d at;
  double reach = 0;                  ///< px, within which the sides are
  std::array<Pixels, 2> sides;       ///< of the part and of the others, away from the contact
  std::vector<Place> joined, apart;  ///< where the contact is while they are one, and after or before
};

Contact contact_of(const FigureRegions& all, std::size_t polarity, const FigureChange& change,
                   const FigureGround& ground) {
  const auto& regions = all.of[polarity].regions;
  const FigureRegion &whole = regions[change.whole], &part = regions[change.part];
  const bool splits = part.frame > whole.frame;
  const auto& parts = splits ? whole.next : whole.before;
  const FigureMotion& motion = splits ? ground.to[whole.frame] : ground.from[whole.frame];
  Contact contact;
  contact.at = moved(motion, ground.view.size, change.at.x, change.at.y);
  contact.reach = std::max(kNear, 2 * part.width());
  contact.joined = followed({whole.frame, change.at}, !splits, ground);
  contact.apart = followed({part.frame, contact.at}, splits, ground);
  const cv::Mat1i numbers = region_numbers(all, polarity, part.frame);
  std::array<std::vector<std::pair<double, cv::Point>>, 2> sides;
  const cv::Rect box = square_about(contact.at, static_cast<int>(contact.reach) + 1, numbers.size());
  for (int y = box.y; y < box.br().y; ++y)
    for (int x = box.x; x < box.br().x; ++x) {
      if (numbers(y, x) == 0) continue;
      const double apart = std::hypot(x - contact.at.x, y - contact.at.y);
      const auto region = static_cast<std::size_t>(numbers(y, x) - 1);
      if (apart > contact.reach || std::ranges::find(parts, region) == parts.end()) continue;
      sides[region == change.part ? 0 : 1].emplace_back(apart, cv::Point(x, y));
    }
  for (std::size_t i = 0; i < sides.size(); ++i) contact.sides[i] = farther_half(sides[i]);
  return contact;
}

/// Returns whether a path about the contact joins its sides in a frame, through pixels with `bit`.
bool is_joined(const FigureRegions& all, int bit, const Contact& contact, const Place& place) {
  const cv::Rect box =
      square_about(place.at, static_cast<int>(contact.reach) + 2, all.labels[place.frame].size());
  if (box.empty()) return false;
  cv::Mat1i numbers;
  cv::connectedComponents(cv::Mat((all.labels[place.frame](box) & bit) != 0), numbers, 8, CV_32S);
  const cv::Point2d shift = place.at - contact.at - cv::Point2d(box.tl());
  std::array<std::set<int>, 2> touched;
  for (std::size_t i = 0; i < touched.size(); ++i)
    for (const cv::Point& pixel : contact.sides[i]) {
      const cv::Point to = shifted(pixel, shift);
      if (cv::Rect({0, 0}, box.size()).contains(to) && numbers(to) != 0) touched[i].insert(numbers(to));
    }
  return std::ranges::any_of(touched[0], [&](int i) { return touched[1].contains(i); });
}

/// Returns the pixels of a figure with `bit` where it is followed to.
int count_there(const FigureRegions& all, int bit, const Pixels& figure, cv::Point2d centre,
                const Place& place) {
  const cv::Mat1b& labels = all.labels[place.frame];
  const cv::Point2d shift = place.at - centre;
  return static_cast<int>(std::ranges::count_if(figure, [&](const cv::Point& pixel) {
    const cv::Point to = shifted(pixel, shift);
    return cv::Rect({0, 0}, labels.size()).contains(to) && (labels(to) & bit) != 0;
  }));
}

/// Returns how many thresholds see a split or merge: at which a path joins the sides on one hand alone.
int seen_contact(const FigureRegions& all, std::size_t polarity, const FigureChange& change,
                 const FigureGround& ground) {
  const Contact contact = contact_of(all, polarity, change, ground);
  int seen = 1;  // at the first one it is found
  for (std::size_t k = 1; k < kFigureThresholds.size(); ++k) {
    const auto joined = [&](const Place& place) {
      return is_joined(all, label_bit(polarity, k), contact, place);
    };
    if (std::ranges::any_of(contact.joined, joined) && !std::ranges::all_of(contact.apart, joined)) ++seen;
  }
  return seen;
}

/// Returns how many thresholds see a birth or death: at which the figure is there on one hand alone.
int seen_end(const FigureRegions& all, std::size_t polarity, const FigureChange& change,
             const FigureGround& ground) {
  const FigureRegion& figure = all.of[polarity].regions[change.whole];
  const bool is_birth = change.type == graph::EventType::birth;
  const cv::Mat1i numbers = region_numbers(all, polarity, figure.frame);
  Pixels pixels;
  for (int y = figure.box.y; y < figure.box.br().y; ++y)
    for (int x = figure.box.x; x < figure.box.br().x; ++x)
      if (numbers(y, x) == static_cast<int>(change.whole) + 1) pixels.emplace_back(x, y);
  const auto there = followed({figure.frame, figure.centre}, is_birth, ground),
             away = followed({figure.frame, figure.centre}, !is_birth, ground);
  int seen = 1;
  for (std::size_t k = 1; k < kFigureThresholds.size(); ++k) {
    const auto count = [&](const Place& place) {
      return count_there(all, label_bit(polarity, k), pixels, figure.centre, place);
    };
    const bool is_there =
        std::ranges::any_of(there, [&](const Place& place) { return count(place) >= kLeastThere; });
    const bool is_away = std::any_of(away.begin() + 1, away.end(), [&](const Place& place) {
      return count(place) < kLeftShare * double(pixels.size());
    });
    if (is_there && is_away) ++seen;
  }
  return seen;
}

}  // namespace

std::vector<FigureEvent> weigh_figure_changes(const FigureRegions& all, const FigureGround& ground,
                                              const core::Context& context) {
  std::vector<FigureEvent> events;
  for (std::size_t p = 0; p < all.of.size(); ++p)
    for (const FigureChange& change : find_figure_changes(all, p, ground, context))
      events.push_back({change, p, 0});
  core::parallel_for(events.size(), context, [&](std::size_t i) {
    FigureEvent& event = events[i];
    const bool is_end = event.change.whole == event.change.part;
    const int seen = is_end ? seen_end(all, event.polarity, event.change, ground)
                            : seen_contact(all, event.polarity, event.change, ground);
    event.probability = seen / double(kFigureThresholds.size());
  });
  return events;
}

}  // namespace emberfold::pipeline
