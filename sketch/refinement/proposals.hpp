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

/// Holds an edit, its change of the length, and the patches it concerns. The concerned patches of two edits
/// of a round must not meet.
struct Proposal {
  double change = 0;  // nats
  GraphEdit edit;
  std::vector<Slot> concerns;
};

/// Returns whether one patch lies on the other.
/// That is within 3 px along it, and its core and a blur (1.5 px at least) across.
bool patches_overlap(const graph::Patch& a, const graph::Patch& b);

/// Returns the coding in the axis of greatest gain; in luma where no axis gains.
Coding best_coding(std::span<const CodingContext> axes, const graph::Patch& patch);

/// Results of ProposalBuilder::fit_like by all its arguments, since most calls repeat in the next round.
using FitCache = std::map<std::array<double, 8>, std::optional<graph::Patch>>;

/// Builds patches and proposals for the edits of one round, from a graph on its frame.
class ProposalBuilder {
 public:
  ProposalBuilder(const EditableGraph& draft, const cv::Mat& levels, std::span<const CodingContext> axes,
                  const RefineOptions& refinement, FitCache& cache);

  [[nodiscard]] const EditableGraph& draft() const { return draft_; }
  [[nodiscard]] double spacing() const { return refinement_.spacing; }

  /// Fits a patch of the same kind at another place or a little beside it, with its cost and gain. None if
  /// the patch there is of another kind or has less than half of `contrast`.
  std::optional<graph::Patch> fit_like(const graph::Patch& patch, graph::Point position, double theta,
                                       double contrast);
  /// Returns the least share of `contrast` that shows on the way from one place to another, pixel by pixel.
  /// Measured is luma's difference across the way, as the patch's profile has it: finer than a fitted patch,
  /// so less sure. Stops early where less than `enough` shows.
  [[nodiscard]] double visible_contrast(const graph::Patch& patch, graph::Point from, graph::Point to,
                                        double contrast, double enough) const;
  /// Tells whether a gap shows between two strokes, of which these are the patches from the gap on: a narrow
  /// one too, that visible_contrast() evens out.
  [[nodiscard]] bool shows_gap(const std::vector<Slot>& before, const std::vector<Slot>& after) const;
  /// Returns the patch with its cost and gain.
  [[nodiscard]] graph::Patch with_coding_cost(graph::Patch patch) const;
  /// Returns whether a patch would lie on a patch of the graph that is none of `besides`.
  [[nodiscard]] bool overlaps(const graph::Patch& patch, std::span<const Slot> besides) const;
  /// Returns the patches within kRadius px, ascending.
  [[nodiscard]] std::vector<Slot> patches_near(graph::Point place) const;
  static constexpr double kRadius = 20;

  /// Keeps the edit if it shortens the code by more than a nat.
  void propose(GraphEdit edit, std::vector<Slot> concerns);
  std::vector<Proposal> take_proposals() { return std::move(proposals_); }

 private:
  [[nodiscard]] std::optional<graph::Patch> fitted_like(const graph::Patch& patch, graph::Point position,
                                                        double theta, double contrast) const;

  const EditableGraph& draft_;
  const cv::Mat& levels_;
  std::span<const CodingContext> axes_;  // luma first
  RefineOptions refinement_;
  FitCache& cache_;
  std::vector<Slot> held_;  // of the draft
  graph::detail::PointGrid near_;
  std::vector<Proposal> proposals_;
};

/// Returns the curves of patches between those whose degree is not 2, as graph::Curve has them.
std::vector<std::vector<Slot>> find_strokes(const EditableGraph& draft);

/// Returns a stroke's patches from its free end on, at most six.
std::vector<Slot> stroke_tail(const EditableGraph& draft, Slot end);
/// Returns the median of the patches' |contrast|.
double median_contrast(const EditableGraph& draft, const std::vector<Slot>& slots);

void propose_at_ends(ProposalBuilder& editor);      // proposals_ends.cpp
void propose_meetings(ProposalBuilder& editor);     // proposals_junctions.cpp
void propose_for_strokes(ProposalBuilder& editor);  // proposals_strokes.cpp

}  // namespace emberfold::sketch
