// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/matching/point_grid.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/footage/play_order.hpp"
#include "pipeline/strokes/stroke_families.hpp"

namespace emberfold::pipeline {

constexpr double kStripReach = 16;  ///< px to each side of its curves within which a stroke shows the clip

/// A stroke of the clip that lives again, at one moment.
struct RepeatedStroke {
  std::size_t family = 0;  ///< StrokeFamilies::lives
  int frame = 0;           ///< of the clip
  graph::Point offset;     ///< whole px, from its place there
  double share = 1;        ///< of its strip's width, 0…1: strips widen at birth and narrow before death
};

/// Content of one moment of a clip whose strokes live again.
struct StrokeMoment {
  PlayedMoment shown;  ///< of the strokes that last
  std::vector<RepeatedStroke> strokes;
  graph::AttributeGraph graph;     ///< a patch keeps its id as long as links of the clip carry it on
  std::array<int, 6> operators{};  ///< births, deaths, splits, merges, connects, disconnects
};

/// Returns the first edit that strokes which live again cannot show; empty where there is none.
/// Accepts speed, reverse, wind, birth_map, births and more deaths of a MotionEdit.
std::string edit_not_repeated(const mcmc::MotionEdit& edit);

/// Draws at which moments the strokes of a clip live again, and where.
/// A family of strokes lives as it was seen, frame by frame, with all its splits and joins. Families that are
/// there for most of the clip are always there and follow a play order of its frames. All others are born as
/// often as in the clip, each within some pixels of where it was, at a moment at which its surroundings look
/// alike; more often where fewer patches are there than usual.
class StrokePlay {
 public:
  /// `moments`: compare_moments of the clip's frames. Throws core::InputError for an edit that is not
  /// possible (edit_not_repeated).
  StrokePlay(std::shared_ptr<const SeenClip> clip, LikeMoments moments, const mcmc::MotionEdit& edit,
             std::uint64_t seed);

  /// Returns the next moment.
  StrokeMoment next();
  [[nodiscard]] const StrokeFamilies& families() const { return families_; }

 private:
  struct Living {
    std::size_t family = 0;
    double begin = 0;  // moment; counted in frames of the clip from there
    graph::Point offset;
    StrokeAgain shown;
  };
  struct Candidate {
    std::uint32_t at = 0;  // in waiting_
    graph::Point offset;
  };
  [[nodiscard]] bool lasts(const StrokeLife& life) const;
  [[nodiscard]] int age(const Living& one) const;
  void end_strokes(core::Rng& rng, StrokeMoment& moment);
  void bear_strokes(int head, core::Rng& rng, StrokeMoment& moment);
  [[nodiscard]] const std::uint8_t* shown_at(graph::Point at, int head, int later) const;
  [[nodiscard]] double misfit(const StrokeLife& life, graph::Point offset, int head) const;
  [[nodiscard]] std::optional<Candidate> draw_candidate(bool in_company, int head, core::Rng& rng) const;
  void bear_one(int head, core::Rng& rng);
  void place(Living& one, int frame, double share, StrokeMoment& moment);
  void count_events(const RepeatedStroke& stroke, StrokeMoment& moment) const;

  std::shared_ptr<const SeenClip> clip_;
  StrokeFamilies families_;
  PlayOrder order_;
  mcmc::MotionEdit edit_;
  std::uint64_t seed_;
  std::vector<std::size_t> passing_;  // families that do not last
  std::vector<std::size_t> waiting_;  // of them those to be born next
  double usual_patches_ = 0;          // of passing families in a frame
  std::vector<Living> lasting_, living_, born_;
  std::vector<graph::Vertex> vertices_;  // of the moment
  std::vector<graph::Edge> edges_;
  // Patches of living_ in the frame before: their places, their strokes, and an index by place.
  std::vector<graph::Point> places_;
  std::vector<std::size_t> owners_;
  std::optional<graph::detail::PointGrid> there_;
  std::int64_t moment_ = -1;
  std::uint32_t next_id_ = 0;
};

}  // namespace emberfold::pipeline
