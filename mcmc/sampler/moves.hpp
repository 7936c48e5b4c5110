// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "mcmc/sampler/choices.hpp"
#include "mcmc/sampler/state_change.hpp"

namespace emberfold::mcmc {

/// Proposes one of a reversible pair of moves.
/// Changes the state by `change` and returns log q(x′ → x) − log q(x → x′), from the probabilities of its
/// draws forwards and backwards. Returns nothing, with the state unchanged, where the draw is not possible.
/// `frame`: the frame it works on, or the first of the two between which it works. Reads at most two frames
/// back and three ahead. Density and proposals share one measure, so there is no Jacobian.
using Propose = std::optional<double> (*)(StateChange& change, ChoiceSource& draws, int frame);

/// Holds a move and how often it is tried.
struct Move {
  std::string_view name;
  Propose propose;
  double weight = 1;            ///< how often it is tried, relative to the others
  bool between_frames = false;  ///< it needs a next frame
  bool over_time = false;       ///< it may change and read any later frame
};
/// Lists all moves (Wang & Zhu 2004 name seven: switch, connect, cut, split, merge, add, delete).
std::span<const Move> moves();

// Links between frames (move_links.cpp).
std::optional<double> link_or_unlink(StateChange& change, ChoiceSource& draws, int frame);
/// Exchanges the ends of two links: (a, b), (c, d) → (a, d), (c, b).
std::optional<double> switch_links(StateChange& change, ChoiceSource& draws, int frame);
/// Moves one end of a link to another node.
std::optional<double> relink(StateChange& change, ChoiceSource& draws, int frame);

// Edges and patches of a frame (move_connect_cut.cpp, move_add_delete.cpp, move_split_merge.cpp).
std::optional<double> connect_or_cut(StateChange& change, ChoiceSource& draws, int frame);
/// Adds a candidate with edges and links drawn among nodes nearby, or deletes a patch.
std::optional<double> add_or_delete(StateChange& change, ChoiceSource& draws, int frame);
/// Splits off some of a patch's edges, and perhaps its past, to a candidate beside it; or merges a neighbour.
std::optional<double> split_or_merge(StateChange& change, ChoiceSource& draws, int frame);

/// Adds patches that follow each other from `frame` on, joined to nothing, or deletes such a track
/// (move_tracks.cpp).
std::optional<double> add_or_delete_track(StateChange& change, ChoiceSource& draws, int frame);

// Whole stretches of curves (move_strokes.cpp).
/// Moves each patch's past along a curve to its neighbour.
std::optional<double> shift_links(StateChange& change, ChoiceSource& draws, int frame);
/// Makes or removes all links between two strokes at once.
std::optional<double> link_strokes(StateChange& change, ChoiceSource& draws, int frame);
/// Gives a stroke the past of another stroke.
std::optional<double> relink_stroke(StateChange& change, ChoiceSource& draws, int frame);

}  // namespace emberfold::mcmc
