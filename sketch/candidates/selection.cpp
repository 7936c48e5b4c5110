// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "sketch/candidates/curve_pixels.hpp"
#include "sketch/candidates/ramps.hpp"
#include "sketch/candidates/section_choice.hpp"
#include "sketch/candidates/trial_shapes.hpp"

namespace emberfold::sketch {

namespace {

// A section with the profile that explains most.
struct Trial {
  CurveSection section;
  std::vector<CurvePixel>::size_type begin = 0, end = 0;  // of its pixels
  const TrialShape* shape = nullptr;                      // none: no profile of the kind fits
  TrialLevels levels;
  double cost = 0, gain = 0;  // nats; the gain is that at its choice
  bool on = false;
};

struct Candidate {
  Chain chain;
  const TrialShapes* shapes = nullptr;
  std::vector<Trial> trials;
};

// Squared errors with which the chosen curves explain a pixel; < 0: none does.
struct Explained {
  float best = -1, second = -1;  // `second`: of the other curves
  std::int32_t by = -1;          // candidate that explains best
};

double nats_saved(double n, double before, double after, double variance) {
  return 0.5 * n * std::log((before + n * variance) / (after + n * variance));
}

double level_at(const Trial& t, const TrialShapes& shapes, double across) {
  const auto k = static_cast<std::size_t>(shapes.bin_at(across));
  const double a = double{t.shape->first[k]}, b = double{t.shape->second[k]};
  return t.levels.left + a * (t.levels.middle - t.levels.left) + b * (t.levels.right - t.levels.middle);
}

// Does not depend on where a curve was entered, nor on its direction.
double total_contrast(const Chain& chain) {
  double sum = 0;
  for (const CreasePoint& p : chain.points) sum += p.contrast;
  return sum;
}

class Selection {
 public:
  Selection(const ScaleSpace& space, const cv::Mat1f& luma, const SelectionOptions& options)
      : space_(space), luma_(luma), options_(options), explained_(luma.total()) {
    constexpr double kTolerance = 1.5;  // grey levels: a profile that is off by less looks right
    variance_ = options.noise * options.noise + kTolerance * kTolerance;
    for (const ScaleLevel& level : space) shapes_.push_back(make_trial_shapes(level.sigma));
  }

  void add(std::vector<Chain> chains) {
    std::ranges::sort(chains, std::greater<>(), total_contrast);
    for (Chain& chain : chains) {
      const std::size_t level = median_level(chain.points, space_);
      Candidate candidate{std::move(chain), &shapes_[level], {}};
      const double length = std::clamp(1.5 * space_[level].sigma, 4.0, 8.0);
      for (const CurveSection& section : cut_into_sections(candidate.chain, length))
        candidate.trials.push_back({.section = section, .levels = {}});
      candidates_.push_back(std::move(candidate));
      extend(candidates_.size() - 1);
    }
  }

  // Switches on the sections of step edges that pay now.
  bool extend_edges() {
    bool any = false;
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (!is_line(candidates_[c])) any |= extend(c);
    return any;
  }

  void drop_redundant() {
    constexpr int kRounds = 8;
    std::vector<char> touched;
    for (int round = 0; round < kRounds && drop_most_redundant(touched); ++round) {
      std::fill(explained_.begin(), explained_.end(), Explained{});
      for (std::size_t c = 0; c < candidates_.size(); ++c)
        for (const Trial& t : candidates_[c].trials)
          if (t.on && t.shape != nullptr) explain(candidates_[c], t, static_cast<std::int32_t>(c));
    }
  }

  [[nodiscard]] std::vector<Chain> chosen() const {
    std::vector<Chain> chains;
    for (const Candidate& c : candidates_) append_chosen(c, chains);
    return chains;
  }

 private:
  // Nats for an end of a curve: a place among some 400. Set by hand.
  static constexpr double kEndCost = 6;
  // Numbers that a section has beyond an even ramp: the levels of both sides and a place of a step. A line
  // has paid where it was found; it pays a little again, so that it goes where outlines explain all of it.
  static constexpr double kStepNumbers = 3, kLineNumbers = 0.1;

  static bool is_line(const Candidate& c) { return c.chain.kind != CreaseKind::step; }
  static const std::vector<TrialShape>& shapes_of(const Candidate& c) {
    return is_line(c) ? c.shapes->bars : c.shapes->steps;
  }

  static double sum_of(const Candidate& c, const std::vector<double>& nats) {
    double sum = 0;
    for (std::size_t i = 0; i < nats.size(); ++i) sum += c.trials[i].on ? nats[i] : 0;
    return sum;
  }

  // Residual variance that is accepted: noise, 1.5 grey levels and 5 % of the contrast.
  [[nodiscard]] double tolerated(const TrialLevels& levels) const {
    constexpr double kShare = 0.05;  // of the contrast
    const double error =
        kShare * std::max(std::abs(levels.middle - levels.left), std::abs(levels.middle - levels.right));
    return variance_ + error * error;
  }

  [[nodiscard]] double luma_at(const CurvePixel& p) const { return double{luma_.ptr<float>()[p.index]}; }
  [[nodiscard]] std::span<const CurvePixel> pixels_of(const Trial& t) const {
    return std::span(pixels_).subspan(t.begin, t.end - t.begin);
  }

  // Switches on the sections of a curve that pay; all of a line.
  bool extend(std::size_t id) {
    Candidate& c = candidates_[id];
    const bool line = is_line(c);
    if (!line && nearly_all_explained(c)) return false;
    gains_.clear();
    for (Trial& t : c.trials) {
      if (!t.on) t.gain = try_profile(c, t);
      gains_.push_back(t.gain);
    }
    on_ = choose_sections(gains_, kEndCost, c.chain.closed);
    bool any = false;
    for (std::size_t i = 0; i < on_.size(); ++i) {
      Trial& t = c.trials[i];
      if (t.on || !(line || (t.shape != nullptr && on_[i] != 0))) continue;
      t.on = any = true;
      if (t.shape != nullptr) explain(c, t, static_cast<std::int32_t>(id));
    }
    return any;
  }

  // Returns whether others explain the image all along a curve.
  [[nodiscard]] bool nearly_all_explained(const Candidate& c) const {
    constexpr double kNearly = 0.9;
    std::size_t count = 0;
    for (const CreasePoint& p : c.chain.points) {
      const int x = std::clamp(static_cast<int>(std::lround(p.position.x)), 0, luma_.cols - 1),
                y = std::clamp(static_cast<int>(std::lround(p.position.y)), 0, luma_.rows - 1);
      const float best = explained_[static_cast<std::size_t>(y) * static_cast<std::size_t>(luma_.cols) +
                                    static_cast<std::size_t>(x)]
                             .best;
      count += best >= 0 && double{best} <= kWell * variance_ ? 1 : 0;
    }
    return static_cast<double>(count) > kNearly * static_cast<double>(c.chain.points.size());
  }

  // Fits the best profile; returns the nats that it saves beyond its cost, given what is explained already.
  double try_profile(const Candidate& c, Trial& t) {
    constexpr double kNothing = -1e3;
    if (t.end > t.begin) return gain(c, t);
    t.begin = pixels_.size();
    double reach = 0;
    for (const TrialShape& shape : shapes_of(c)) reach = std::max(reach, shape.reach);
    add_section_pixels(c.chain, t.section, reach, luma_.size(), pixels_);
    t.end = pixels_.size();
    fit(c, t);
    if (t.shape == nullptr) {
      pixels_.resize(t.begin);
      t.end = t.begin;
      return kNothing;
    }
    const auto kept =
        std::remove_if(pixels_.begin() + static_cast<std::ptrdiff_t>(t.begin), pixels_.end(),
                       [&](const CurvePixel& p) { return std::abs(double{p.across}) > t.shape->reach; });
    pixels_.erase(kept, pixels_.end());
    t.end = pixels_.size();
    return gain(c, t);
  }

  void fit(const Candidate& c, Trial& t) {
    const bool step = !is_line(c);
    bins_.assign(c.shapes->bins(), {});
    const auto pixels = pixels_of(t);
    if (pixels.empty()) return;
    const double origin = luma_at(pixels.front());
    for (const CurvePixel& p : pixels)
      bins_[static_cast<std::size_t>(c.shapes->bin_at(double{p.across}))].add(luma_at(p) - origin,
                                                                              double{p.across});
    double best = -1e9;
    for (const TrialShape& shape : shapes_of(c)) {
      RampSums all;
      for (int k = c.shapes->half - shape.bins; k <= c.shapes->half + shape.bins; ++k)
        all.add(bins_[static_cast<std::size_t>(k)]);
      if (all.n < 8) continue;
      const TrialLevels levels = step
                                     ? fit_step(shape, bins_, all)
                                     : fit_bar(shape, bins_, all, c.chain.kind == CreaseKind::ridge ? 1 : -1);
      if (levels.residual < 0 || (step && levels.right - levels.left < options_.visible_contrast)) continue;
      const double cost =
          options_.exchange_rate * (step ? kStepNumbers : kLineNumbers) * 0.5 * std::log1p(all.n);
      const double saved = nats_saved(all.n, all.residual(), levels.residual, tolerated(levels)) - cost;
      if (saved <= best) continue;
      best = saved;
      t.shape = &shape, t.cost = cost;
      t.levels = {levels.residual, levels.left + origin, levels.middle + origin, levels.right + origin};
    }
  }

  // The nats that a section saves beyond its cost, given what is explained already.
  double gain(const Candidate& c, const Trial& t) {
    ramps_.reset(c.shapes->bins());
    double explained = 0, better = 0, own = 0;
    for (const CurvePixel& p : pixels_of(t)) {
      const double across = double{p.across}, e = luma_at(p) - level_at(t, *c.shapes, across);
      const double other = double{explained_[static_cast<std::size_t>(p.index)].best};
      const int bin = c.shapes->bin_at(across);
      if (other < 0) {
        own += e * e;
        ramps_.add(bin, luma_at(p) - t.levels.middle, across);
        continue;
      }
      explained += other;
      ramps_.add_other(bin);
      if (std::abs(across) <= t.shape->core()) better += other - e * e;
    }
    return nats_saved(static_cast<double>(t.end - t.begin), explained + ramps_.residual(),
                      explained - std::max(0.0, better) + own, tolerated(t.levels)) -
           t.cost;
  }

  // The nats that are lost without a section that is on.
  double loss(const Candidate& c, const Trial& t, std::int32_t id) {
    ramps_.reset(c.shapes->bins());
    double rest = 0, worse = 0, own = 0;
    for (const CurvePixel& p : pixels_of(t)) {
      const Explained& e = explained_[static_cast<std::size_t>(p.index)];
      const double across = double{p.across}, other = double{e.by == id ? e.second : e.best};
      const int bin = c.shapes->bin_at(across);
      const double error = luma_at(p) - level_at(t, *c.shapes, across);
      if (other < 0) {
        own += error * error;
        ramps_.add(bin, luma_at(p) - t.levels.middle, across);
        continue;
      }
      ramps_.add_other(bin);
      rest += double{e.best};
      if (std::abs(across) <= t.shape->core()) worse += other - (e.by == id ? double{e.best} : error * error);
    }
    return nats_saved(static_cast<double>(t.end - t.begin), rest + std::max(0.0, worse) + ramps_.residual(),
                      rest + own, tolerated(t.levels)) -
           t.cost;
  }

  void explain(const Candidate& c, const Trial& t, std::int32_t id) {
    for (const CurvePixel& p : pixels_of(t)) {
      const double across = double{p.across}, d = luma_at(p) - level_at(t, *c.shapes, across);
      if (std::abs(across) > t.shape->core() && d * d > kWell * variance_) continue;
      const auto error = static_cast<float>(d * d);
      Explained& e = explained_[static_cast<std::size_t>(p.index)];
      if (e.by == id) {
        e.best = std::min(e.best, error);
      } else if (e.best < 0 || error < e.best) {
        e = {error, e.best, id};
      } else if (e.second < 0 || error < e.second) {
        e.second = error;
      }
    }
  }

  // Switches off what pays least, where nothing else was switched off in this round.
  bool drop_most_redundant(std::vector<char>& touched) {
    struct Loss {
      double nats;
      std::size_t candidate;
      std::vector<char> keep;
    };
    std::vector<Loss> losing;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const Candidate& candidate = candidates_[c];
      gains_.clear();
      bool any = false;
      for (const Trial& t : candidate.trials) {
        any |= t.on;
        gains_.push_back(!t.on                ? -1e3
                         : t.shape == nullptr ? 0.0
                                              : loss(candidate, t, static_cast<std::int32_t>(c)));
      }
      if (!any) continue;
      on_ = choose_sections(gains_, kEndCost, candidate.chain.closed);
      if (is_line(candidate)) on_.assign(gains_.size(), sum_of(candidate, gains_) >= 0 ? 1 : 0);
      double nats = 0;
      bool less = false;
      for (std::size_t i = 0; i < gains_.size(); ++i)
        if (candidate.trials[i].on && on_[i] == 0) nats += gains_[i], less = true;
      if (less) losing.push_back({nats, c, on_});
    }
    std::sort(losing.begin(), losing.end(), [](const Loss& a, const Loss& b) {
      return std::pair(a.nats, a.candidate) < std::pair(b.nats, b.candidate);
    });
    touched.assign(explained_.size(), 0);
    bool any = false;
    for (const Loss& l : losing) {
      Candidate& candidate = candidates_[l.candidate];
      const auto leaves = [&](std::size_t i) { return candidate.trials[i].on && l.keep[i] == 0; };
      bool busy = false;
      for (std::size_t i = 0; i < l.keep.size() && !busy; ++i)
        if (leaves(i))
          busy = std::ranges::any_of(pixels_of(candidate.trials[i]), [&](const CurvePixel& p) {
            return touched[static_cast<std::size_t>(p.index)] != 0;
          });
      if (busy) continue;
      for (std::size_t i = 0; i < l.keep.size(); ++i)
        if (leaves(i)) {
          for (const CurvePixel& p : pixels_of(candidate.trials[i]))
            touched[static_cast<std::size_t>(p.index)] = 1;
          candidate.trials[i].on = false;
          any = true;
        }
    }
    return any;
  }

  // The runs of sections that are on; one that passes the first point of a closed curve stays whole.
  static void append_chosen(const Candidate& c, std::vector<Chain>& chains) {
    const std::size_t n = c.trials.size();
    const auto on = [&](std::size_t i) { return c.trials[i % n].on; };
    std::size_t start = 0;
    if (c.chain.closed) {
      while (start < n && on(start)) ++start;
      if (start == n && n > 0) {
        chains.push_back(c.chain);
        set_evidence(c, 0, n, chains.back());
        begin_at_strongest(chains.back());  // patches are placed from the first point on
        return;
      }
    }
    for (std::size_t i = start; i < start + n; ++i) {
      if (!on(i)) continue;
      std::size_t j = i;
      Chain part{c.chain.kind, {}, false, {0, 0}};
      for (; j < start + n && on(j) && (c.chain.closed || j < n); ++j) {
        const CurveSection& s = c.trials[j % n].section;
        part.points.insert(part.points.end(), c.chain.points.begin() + s.first,
                           c.chain.points.begin() + s.last);
      }
      if (i == 0) part.gap[0] = c.chain.gap[0];
      if (j == n) part.gap[1] = c.chain.gap[1];
      set_evidence(c, i, j, part);
      if (part.points.size() >= 3) chains.push_back(std::move(part));
      i = j - 1;
    }
  }

  static void set_evidence(const Candidate& c, std::size_t from, std::size_t to, Chain& part) {
    if (is_line(c)) return;
    double nats = 0;
    for (std::size_t i = from; i < to; ++i) nats += c.trials[i % c.trials.size()].gain;
    for (CreasePoint& p : part.points)
      p.evidence = std::max(0.0, nats) / static_cast<double>(part.points.size());
  }

  static constexpr double kWell = 4;  // times the variance, of a pixel's squared error

  const ScaleSpace& space_;
  const cv::Mat1f& luma_;
  SelectionOptions options_;
  double variance_ = 1;
  std::vector<TrialShapes> shapes_;
  std::vector<Candidate> candidates_;
  std::vector<CurvePixel> pixels_;
  std::vector<Explained> explained_;
  std::vector<RampSums> bins_;
  Ramps ramps_;
  std::vector<double> gains_;
  std::vector<char> on_;
};

}  // namespace

std::vector<Chain> select_curves(std::vector<Chain> lines, std::vector<std::vector<Chain>> edges,
                                 const ScaleSpace& space, const cv::Mat1f& luma,
                                 const SelectionOptions& options) {
  constexpr int kRounds = 2;  // set by hand; 4 change what is drawn of droplets by .001
  Selection selection(space, luma, options);
  selection.add(std::move(lines));
  for (std::vector<Chain>& level : edges) selection.add(std::move(level));
  selection.drop_redundant();
  for (int round = 0; round < kRounds && selection.extend_edges(); ++round) selection.drop_redundant();
  return selection.chosen();
}

}  // namespace emberfold::sketch
