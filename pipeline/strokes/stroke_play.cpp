// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_play.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>

#include "core/error.hpp"
#include "mcmc/learning/stroke_places.hpp"

namespace emberfold::pipeline {

namespace {

using graph::EventType;
using graph::Point;
using Index = std::uint32_t;

constexpr std::uint32_t kPlayStream = 0x7374726b;  // of the random stream
// Chosen for the look of new clips of six real ones, and their figures in docs/benchmarks.md; no other
// source.
constexpr double kLasting = 0.6;              // share of the clip's frames
constexpr int kFamiliesCompared = 48;         // for a birth
constexpr double kUnfit = 40;                 // grey levels of misfit: nothing is born (but by a map)
constexpr double kBirthJitter = 3;            // px, SD: from a family's place to that of its repetition
constexpr int kFamiliesApart = 8;             // frames between a family's birth and its repetition, at least
constexpr int kCompanyFrames = 1;             // between the births of strokes in company
constexpr double kCrowded = 5;                // px: closer strokes crowd each other,
constexpr double kCrowdCost = 60;             // at so many grey levels of misfit
constexpr std::size_t kPatchesCompared = 10;  // of a family
constexpr double kCompareDistance = 9;        // px to each side of a curve, where levels are compared
constexpr int kMiddleAhead = 8;               // frames, at most, from the birth to the second comparison
constexpr double kMostHurry = 4;              // times as many births as usual, and as few
constexpr int kWidening = 3;                  // frames over which a strip widens and narrows

std::size_t index(EventType type) {
  return static_cast<std::size_t>(type);
}

Point rounded(Point p) {
  return {std::round(p.x), std::round(p.y)};
}

}  // namespace

std::string edit_not_repeated(const mcmc::MotionEdit& edit) {
  if (edit.intensity != 1) return "intensity";
  if (edit.flicker != 1) return "flicker";
  if (edit.contrast != 1) return "contrast";
  if (edit.strokes != mcmc::StrokeChoice::all) return "choice of strokes";
  if (edit.rates[index(EventType::death)] < 1) return "deaths below 1";
  for (const auto type : {EventType::split, EventType::merge, EventType::connect, EventType::disconnect})
    if (edit.rates[index(type)] != 1) return "rate of " + std::string(graph::name(type)) + "s";
  return {};
}

StrokePlay::StrokePlay(std::shared_ptr<const SeenClip> clip, LikeMoments moments,
                       const mcmc::MotionEdit& edit, std::uint64_t seed)
    : clip_(std::move(clip)),
      families_(stroke_families(*clip_)),
      order_(std::move(moments), {.seed = seed}),
      edit_(edit),
      seed_(seed) {
  edit.validate();
  if (const auto what = edit_not_repeated(edit); !what.empty())
    throw core::InputError("strokes that live again cannot show another " + what);
  for (std::size_t f = 0; f < families_.lives.size(); ++f) {
    const auto& life = families_.lives[f];
    if (lasts(life)) {
      lasting_.push_back({f, 0, {}, {}});
      continue;
    }
    passing_.push_back(f);
    for (const auto& patches : life.patches)
      usual_patches_ += static_cast<double>(patches.size()) / clip_->size();
  }
}

bool StrokePlay::lasts(const StrokeLife& life) const {
  return static_cast<double>(life.patches.size()) >= kLasting * clip_->size();
}

/// Returns how many frames of the clip a stroke has lived.
int StrokePlay::age(const Living& one) const {
  return static_cast<int>(std::floor(static_cast<double>(moment_) * edit_.speed - one.begin + 1e-9));
}

/// Ends the strokes whose life is over, and others, where more deaths are asked for.
void StrokePlay::end_strokes(core::Rng& rng, StrokeMoment& moment) {
  auto gone = std::erase_if(living_, [&](const Living& one) {
    return age(one) >= static_cast<int>(families_.lives[one.family].patches.size());
  });
  const double more = (edit_.rates[index(EventType::death)] - 1) * static_cast<double>(passing_.size()) *
                      edit_.speed / clip_->size();
  for (int left = rng.count(more); left > 0 && !living_.empty(); --left, ++gone)
    living_.erase(living_.begin() + rng.below(static_cast<std::uint32_t>(living_.size())));
  moment.operators[index(EventType::death)] += static_cast<int>(gone);
}

void StrokePlay::bear_strokes(int head, core::Rng& rng, StrokeMoment& moment) {
  if (passing_.empty()) return;
  if (moment_ == 0) {  // those that are there in the clip
    for (const auto f : passing_) {
      const auto& life = families_.lives[f];
      const int lived = head - life.first;
      if (lived >= 0 && lived < static_cast<int>(life.patches.size()))
        living_.push_back({f, -double(lived), {}, {}});
    }
    return;
  }
  const double births = edit_.rates[index(EventType::birth)];
  const double lack = births * usual_patches_ / std::max(1.0, static_cast<double>(places_.size()));
  const double hurry = std::clamp(lack * lack, 1 / kMostHurry, kMostHurry);
  const double usual = static_cast<double>(passing_.size()) * edit_.speed / clip_->size();
  there_.emplace(places_, kStripReach);
  born_.clear();
  for (int left = rng.count(births * usual * hurry); left > 0; --left) bear_one(head, rng);
  moment.operators[index(EventType::birth)] += static_cast<int>(born_.size());
  std::ranges::move(born_, std::back_inserter(living_));
}

/// Returns the levels that are shown at a place some frames from now: those of the nearest stroke there, or
/// of the frame that is played.
const std::uint8_t* StrokePlay::shown_at(Point at, int head, int later) const {
  double nearest = kStripReach;
  std::size_t found = places_.size();
  for (const auto i : there_->find_near(at))
    if (const double away = graph::distance(places_[i], at); away < nearest) nearest = away, found = i;
  if (found == places_.size()) return clip_->pixel(std::min(head + later, clip_->size() - 1), at);
  const Living& one = living_[owners_[found]];
  return clip_->pixel(std::min(one.shown.frame + later, clip_->size() - 1), at - rounded(one.offset));
}

/// Returns how unlike the surroundings of a family's birth and of the middle of its life are to what is shown
/// there, grey levels, and how crowded its place is.
double StrokePlay::misfit(const StrokeLife& life, Point offset, int head) const {
  double sum = 0;
  const int middle = std::min(static_cast<int>(life.patches.size()) / 2, kMiddleAhead);
  for (const int lived : {0, middle}) {
    const auto& graph = clip_->graph(life.first + lived);
    const auto& patches = life.patches[static_cast<std::size_t>(lived)];
    if (patches.empty()) continue;
    const int channels = clip_->frame(0).channels();
    const std::size_t step = std::max<std::size_t>(1, patches.size() / kPatchesCompared);
    double unlike = 0, count = 0;
    for (std::size_t k = 0; k < patches.size(); k += step, ++count) {
      const auto& patch = graph.patch(patches[k]);
      const Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
      for (const double side : {-kCompareDistance, kCompareDistance}) {
        const Point from = patch.position + normal * side;
        const auto *a = clip_->pixel(life.first + lived, from), *b = shown_at(from + offset, head, lived);
        for (int c = 0; c < channels; ++c) unlike += std::abs(double(a[c]) - double(b[c])) / (2 * channels);
      }
      const auto near = there_->find_near(patch.position + offset);
      if (lived == 0 && std::ranges::any_of(near, [&](Index i) {
            return graph::distance(places_[i], patch.position + offset) < kCrowded;
          }))
        unlike += kCrowdCost;
    }
    sum += 0.5 * unlike / count;
  }
  return sum;
}

/// Draws a family that waits, and an offset for it: near its own place, or the one of a living stroke at
/// whose time it was born.
std::optional<StrokePlay::Candidate> StrokePlay::draw_candidate(bool in_company, int head,
                                                                core::Rng& rng) const {
  Candidate one;
  if (in_company) {
    const Living& companion = living_[rng.below(static_cast<std::uint32_t>(living_.size()))];
    std::vector<std::uint32_t> born;
    for (std::uint32_t at = 0; at < waiting_.size(); ++at)
      if (std::abs(families_.lives[waiting_[at]].first - companion.shown.frame - 1) <= kCompanyFrames)
        born.push_back(at);
    if (born.empty()) return std::nullopt;
    one.at = born[rng.below(static_cast<std::uint32_t>(born.size()))];
    one.offset = rounded(companion.offset);
    return one;
  }
  one.at = rng.below(static_cast<std::uint32_t>(waiting_.size()));
  const auto& life = families_.lives[waiting_[one.at]];
  one.offset = rounded({kBirthJitter * rng.normal(), kBirthJitter * rng.normal()});
  if (edit_.birth_map)
    one.offset = rounded(mcmc::draw_place(*edit_.birth_map, rng) -
                         mcmc::stroke_middle(clip_->graph(life.first), life.patches.front()));
  else if (clip_->size() > 4 * kFamiliesApart && std::abs(life.first - head) < kFamiliesApart)
    return std::nullopt;
  return one;
}

/// Bears the family that fits best of some that wait.
void StrokePlay::bear_one(int head, core::Rng& rng) {
  // Those that were born least often: else small ones, which fit anywhere, would crowd out the others.
  if (2 * waiting_.size() <= passing_.size())
    waiting_.insert(waiting_.end(), passing_.begin(), passing_.end());
  std::optional<Candidate> best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kFamiliesCompared; ++i) {
    const bool in_company = i % 2 == 1 && !living_.empty() && !edit_.birth_map;
    const auto one = draw_candidate(in_company, head, rng);
    if (!one) continue;
    if (const double found = misfit(families_.lives[waiting_[one->at]], one->offset, head); found < least)
      least = found, best = one;
  }
  if (!best || (least > kUnfit && !edit_.birth_map)) return;
  born_.push_back({waiting_[best->at], static_cast<double>(moment_) * edit_.speed, best->offset, {}});
  waiting_.erase(waiting_.begin() + best->at);
}

/// Counts the events of the clip that a stroke repeats at this moment.
void StrokePlay::count_events(const RepeatedStroke& stroke, StrokeMoment& moment) const {
  for (const auto& [event, frame, path] : clip_->events(stroke.frame)) {
    if (event.before.empty() || event.after.empty()) continue;
    const auto found = families_.of_stroke.find(event.before.front());
    if (found != families_.of_stroke.end() && found->second == stroke.family)
      ++moment.operators[index(event.type)];
  }
}

/// Adds a stroke, as it was in a frame of the clip, to the moment.
void StrokePlay::place(Living& one, int frame, double share, StrokeMoment& moment) {
  const auto& life = families_.lives[one.family];
  const bool next = one.shown.frame >= 0 && frame == one.shown.frame + 1;
  one.shown.go_to(*clip_, frame, life.patches[static_cast<std::size_t>(frame - life.first)], next_id_);
  const RepeatedStroke stroke{one.family, frame, rounded(one.offset), share};
  one.shown.add_to(vertices_, edges_, *clip_, stroke.offset);
  if (next) count_events(stroke, moment);
  moment.strokes.push_back(stroke);
}

StrokeMoment StrokePlay::next() {
  ++moment_;
  core::Rng rng(seed_, {kPlayStream, static_cast<std::uint32_t>(moment_), 0});
  StrokeMoment moment;
  moment.shown = order_.at(std::llround(static_cast<double>(moment_) * edit_.speed));
  const int head = shown_frame(moment.shown);
  bear_strokes(head, rng, moment);
  end_strokes(rng, moment);
  vertices_.clear(), edges_.clear();
  for (Living& one : lasting_) {
    const auto& life = families_.lives[one.family];
    const int lived = head - life.first;
    if (lived >= 0 && lived < static_cast<int>(life.patches.size()))
      place(one, head, 1, moment);
    else
      one.shown = {};
  }
  places_.clear(), owners_.clear();
  for (std::size_t i = 0; i < living_.size(); ++i) {
    Living& one = living_[i];
    const auto before = vertices_.size();
    const auto& life = families_.lives[one.family];
    const int lived = age(one), left = static_cast<int>(life.patches.size()) - lived;
    const double opening = one.begin > 0 ? double(lived + 1) / kWidening : 1;
    if (moment_ > 0) one.offset = one.offset + edit_.wind;
    place(one, life.first + lived, std::min({1.0, opening, double(left) / kWidening}), moment);
    for (auto v = before; v < vertices_.size(); ++v) {
      places_.push_back(vertices_[v].patch.position);
      owners_.push_back(i);
    }
  }
  moment.graph = {vertices_, edges_};
  return moment;
}

}  // namespace emberfold::pipeline
