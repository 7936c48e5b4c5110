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

/// A moment of an edited clip: its graph, and what is drawn over the frame that was seen.
struct CarriedMoment {
  graph::AttributeGraph graph;         ///< strokes keep their vertex ids as long as they live
  std::vector<CarriedStroke> strokes;  ///< in the order in which they are drawn
  std::array<int, 6> operators{};      ///< births, deaths, splits, merges, connects, disconnects
};

/// Returns the first of the edits that no clip can show whose strokes are carried; empty where there is none:
/// of MotionEdit those of speed, reverse, strokes, birth_map, wind and rates, but no fewer deaths, splits or
/// disconnects and no more merges or connects.
std::string edit_not_carried(const mcmc::MotionEdit& edit);

/// Edits the strokes of a clip while its frames are played. What is not edited stays as it was seen.
/// More births: other strokes of the clip live once more, near where they lived. Fewer: strokes are hidden
/// from their birth on. Splits and disconnects: gaps are hidden in strokes, whose ends go on; unions that are
/// left out: the patches that would join are hidden. Wind: strokes drift from their birth on, and begin anew
/// where they are when they have come far. Strokes of a ground that stands still do not break, end or drift
/// more often. Each happens as often as the edit asks, in terms of what the clip
/// shows. Speed and sense of time are left to whoever plays the frames.
class CarriedPlay {
 public:
  /// `gaps`: px that a split and a disconnect open. `loop`: moments after which the same frames are shown
  /// again, with the same chances. Throws core::InputError for an edit that is not carried.
  CarriedPlay(std::shared_ptr<const SeenClip> clip, const mcmc::MotionEdit& edit, std::array<double, 2> gaps,
              std::uint64_t seed, std::optional<int> loop = {});

  /// Returns the next moment, which shows this frame of the clip.
  CarriedMoment next(int frame);

 private:
  struct Followed {
    std::uint32_t id = 0;
    int hiding = -1;  // number; −1: it is seen
  };
  struct Hiding {
    HiddenPlace place;
    int begin = 0;         // moment
    bool sudden = false;   // what it hides was not there before
    int chosen = 0;        // moment when the place was
    bool free = true;      // of strokes then
    std::size_t most = 0;  // patches that it hides at most; 0: any number, as of a whole stroke
    int drift = -1;        // moments after which the stroke is back at its place; −1: it does not drift
  };
  struct Again {  // a stroke that lives once more
    const StrokeLife* life = nullptr;
    int begin = 0;  // moment
    graph::Point offset;
    std::vector<std::uint32_t> ids;  // of its patches now
  };
  struct Played {  // what happens between the moment before and this one
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
  void end_stroke(core::Rng& rng);
  void open_gap(core::Rng& rng, bool at_junction);
  void bear_again(core::Rng& rng);
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
  double usual_width_ = 0;  // with a choice of strokes: between the coarse and the fine ones
  int frame_ = -1, moment_ = -1;
  std::uint32_t next_id_ = 0;
  int next_hiding_ = 0;
  std::vector<Followed> now_;  // by vertex of the frame
  std::map<int, Hiding> hidings_;
  std::vector<Again> again_;
};

}  // namespace emberfold::pipeline
