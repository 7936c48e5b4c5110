// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/matching/point_grid.hpp"
#include "sketch/patches/profile.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/refinement/editable_graph.hpp"
#include "sketch/refinement/refine.hpp"

namespace emberfold::sketch {

/// What an edit would change, and which patches it concerns: the places of no two edits of a round may meet.
struct Proposal {
  double change = 0;  // nats
  Edit edit;
  std::vector<Slot> concerns;
};

/// Does the edits that shorten the code most and do not meet; whether there were any.
bool apply_best(Draft& draft, std::vector<Proposal> proposals);  // refine.cpp

/// Across a straight patch, one a pixel.
std::vector<Rib> ribs_across(graph::Point position, double theta, double length);

/// Whether one patch lies on the other: within 3 px along it, its core and a blur (1.5 px at least) across.
bool overlap(const graph::Patch& a, const graph::Patch& b);

/// In the axis in which the patch gains most; in luma where none gains.
Coding best_coding(std::span<const GainFrame> axes, const graph::Patch& patch);

/// What Editor::like found, by all that it was asked: most of it is asked again in the next round.
using Tried = std::map<std::array<double, 8>, std::optional<graph::Patch>>;

/// A draft on its frame: makes patches and proposals, for the edits of one round.
class Editor {
 public:
  Editor(const Draft& draft, const cv::Mat& levels, std::span<const GainFrame> axes,
         const Refinement& refinement, Tried& tried);

  [[nodiscard]] const Draft& draft() const { return draft_; }
  [[nodiscard]] double spacing() const { return refinement_.spacing; }
  [[nodiscard]] const cv::Mat& levels() const { return levels_; }

  /// A patch like this one, fitted at another place or a little beside it, with its cost and gain; none if
  /// what is there is of another kind or shows less than half of `contrast`.
  std::optional<graph::Patch> like(const graph::Patch& patch, graph::Point position, double theta,
                                   double contrast);
  /// The least share of `contrast` that shows on the way from one place to another, a pixel at a time: luma's
  /// difference across it, as the patch's profile has it. Finer than a fitted patch, so less sure. Looks no
  /// further where less than `enough` shows.
  [[nodiscard]] double shown(const graph::Patch& patch, graph::Point from, graph::Point to, double contrast,
                             double enough) const;
  /// Its cost and gain.
  [[nodiscard]] graph::Patch judged(graph::Patch patch) const;
  /// Whether a patch at this place would lie on a patch of the draft that is none of `besides`.
  [[nodiscard]] bool overlaps(const graph::Patch& patch, std::span<const Slot> besides) const;
  /// The patches within `radius` px, ascending.
  [[nodiscard]] std::vector<Slot> around(graph::Point place) const;
  static constexpr double kRadius = 20;

  /// Keeps it, if it shortens the code by more than a nat.
  void propose(Edit edit, std::vector<Slot> concerns);
  std::vector<Proposal> take() { return std::move(proposals_); }

 private:
  [[nodiscard]] std::optional<graph::Patch> fitted_like(const graph::Patch& patch, graph::Point position,
                                                        double theta, double contrast) const;

  const Draft& draft_;
  const cv::Mat& levels_;
  std::span<const GainFrame> axes_;  // luma first
  Refinement refinement_;
  Tried& tried_;
  std::vector<Slot> held_;  // of the draft
  graph::detail::PointGrid near_;
  std::vector<Proposal> proposals_;
};

/// Curves of patches between those whose degree is not 2, as graph::Curve has them.
std::vector<std::vector<Slot>> strokes(const Draft& draft);

/// A stroke's patches from its free end on, at most six, and the median of their |contrast|.
std::vector<Slot> tail(const Draft& draft, Slot end);
double usual_contrast(const Draft& draft, const std::vector<Slot>& slots);

void propose_at_ends(Editor& editor);                                        // edit_ends.cpp
void propose_meetings(Editor& editor);                                       // edit_meetings.cpp
void propose_for_strokes(Editor& editor, bool blobs);                        // edit_strokes.cpp
void propose_offered(Editor& editor, const graph::AttributeGraph& offered);  // edit_offered.cpp

}  // namespace emberfold::sketch
