// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/carried/carried_pixels.hpp"
#include "pipeline/carried/hidden_place.hpp"
#include "pipeline/carried/hiding_choice.hpp"
#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// A moment of an edited clip: its graph, and the strokes drawn over the frame of the clip.
struct CarriedMoment {
  graph::AttributeGraph graph;         ///< strokes keep their vertex ids through their life
  std::vector<CarriedStroke> strokes;  ///< in the order in which they are drawn
  std::array<int, 6> operators{};      ///< births, deaths, splits, merges, connects, disconnects
};

/// Returns the first edit that cannot be made by transferring pixels of strokes; empty where there is none.
/// Accepts speed, reverse, strokes, birth_map, wind and rates of a MotionEdit, but no fewer deaths, splits
/// or disconnects and no more merges or connects.
std::string edit_not_carried(const mcmc::MotionEdit& edit);

/// Edits the strokes of a clip while its frames are played; everything else stays unchanged.
/// More births: other strokes of the clip are repeated, near where they lived. Fewer: strokes are hidden from
/// their birth on. Splits and disconnects: gaps in strokes are hidden, and the ends continue; unions that are
/// left out: the patches that would join are hidden. Wind: strokes drift from their birth on, and return to
/// their place once they are far from it. Strokes of a still background do not break, end or drift more
/// often. Each event happens as often as the edit demands, relative to the clip. Speed and sense of time are
/// left to the caller.
class CarriedPlay {
 public:
  /// `gaps`: px, the widths that a split and a disconnect open. `loop`: moments after which the same frames
  /// are shown again, with the same chances. Throws core::InputError for an edit that is not possible
  /// (edit_not_carried).
  CarriedPlay(std::shared_ptr<const SeenClip> clip, const mcmc::MotionEdit& edit, std::array<double, 2> gaps,
              std::uint64_t seed, std::optional<int> loop = {});

  /// Returns the next moment, which shows this frame of the clip.
  CarriedMoment next(int frame);

 private:
  struct Followed {
    std::uint32_t id = 0;
    int hiding = -1;  // index; −1: visible
  };
  struct Hiding {
    HiddenPlace place;
    int begin = 0;         // moment
    bool sudden = false;   // the hidden patches were absent before
    int chosen = 0;        // moment in which `place` was chosen
    bool free = true;      // no stroke was there then
    std::size_t most = 0;  // maximum number of patches; 0: any number, for a whole stroke
    int drift = -1;        // moments after which the stroke is back at its place; −1: it does not drift
  };
  struct Again {  // a repeated stroke
    const StrokeLife* life = nullptr;
    int begin = 0;  // moment
    graph::Point offset;
    StrokeAgain shown;
  };
  struct Played {  // changes between the previous moment and this one
    int step = 0;  // frames; 0: the first moment, a repeated frame or a jump
    bool first = false;
    std::vector<std::vector<std::uint32_t>> fresh;  // strokes that continue none
  };

  Played follow(int frame);
  [[nodiscard]] int inherited_hiding(const graph::AttributeGraph& graph,
                                     const std::vector<std::uint32_t>& known,
                                     const std::vector<Followed>& now, std::uint32_t vertex) const;
  void begin_strokes(const Played& played, core::Rng& rng, CarriedMoment& moment);
  void change_strokes(const Played& played, core::Rng& rng, CarriedMoment& moment);
  // The next three return whether they could.
  bool end_stroke(core::Rng& rng);
  bool open_gap(core::Rng& rng, bool at_junction);
  bool bear_again(core::Rng& rng);
  int hide(const std::vector<std::uint32_t>& vertices, bool sudden);
  void hide_gap(const std::vector<std::uint32_t>& vertices, bool sudden);
  void choose_place(Hiding& hiding, const std::vector<std::uint32_t>& vertices);
  [[nodiscard]] bool moves(const std::vector<std::uint32_t>& vertices) const;
  void let_drift(const std::vector<std::uint32_t>& vertices, core::Rng& rng);
  [[nodiscard]] bool is_whole(std::uint32_t vertex) const;
  void draw_frame_strokes(CarriedMoment& moment, std::vector<graph::Vertex>& vertices,
                          std::vector<graph::Edge>& edges);
  void draw_again(CarriedMoment& moment, std::vector<graph::Vertex>& vertices,
                  std::vector<graph::Edge>& edges);
  [[nodiscard]] graph::Point drifted(const Hiding& hiding) const;

  std::shared_ptr<const SeenClip> clip_;
  HidingChoice choice_;
  mcmc::MotionEdit edit_;
  std::array<double, 2> gaps_;
  std::uint64_t seed_;
  std::optional<int> loop_;
  cv::Mat1b moves_;         // where the clip moves
  double usual_width_ = 0;  // with a choice of strokes: the limit between coarse and fine ones
  int frame_ = -1, moment_ = -1;
  std::uint32_t next_id_ = 0;
  int next_hiding_ = 0;
  std::vector<Followed> now_;  // by vertex of the frame
  std::map<int, Hiding> hidings_;
  std::vector<Again> again_;
};

}  // namespace emberfold::pipeline
