// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "mcmc/sampler/choices.hpp"
#include "mcmc/sampler/state_change.hpp"

namespace emberfold::mcmc {

/// A reversible pair of moves. It makes its change to the state by `edit` and returns
/// log q(x′ → x) − log q(x → x′), the chances of its draws backwards and forwards; nothing, and the state as
/// it was, where what was drawn cannot be. `frame`: the one it works on, or the first of the two between
/// which it does. Reads no farther than two frames back and three on. (Density and proposals share one
/// measure, so there is no Jacobian.)
using Propose = std::optional<double> (*)(StateChange& change, ChoiceSource& draws, int frame);

struct Move {
  std::string_view name;
  Propose propose;
  double weight = 1;            ///< how often it is tried, relative to the others
  bool between_frames = false;  ///< it has no use in the last frame
};
/// All of them (Wang & Zhu 2004 name seven: switch, connect, cut, split, merge, add, delete).
std::span<const Move> moves();

// Links between frames (move_links.cpp).
std::optional<double> link_or_unlink(StateChange& change, ChoiceSource& draws, int frame);
/// (a, b), (c, d) → (a, d), (c, b).
std::optional<double> switch_links(StateChange& change, ChoiceSource& draws, int frame);
/// One end of a link goes elsewhere.
std::optional<double> relink(StateChange& change, ChoiceSource& draws, int frame);

// Edges and patches of a frame (move_patches.cpp).
std::optional<double> connect_or_cut(StateChange& change, ChoiceSource& draws, int frame);
/// A candidate is put in, with edges and links that are drawn by what is near; or a patch taken out.
std::optional<double> add_or_delete(StateChange& change, ChoiceSource& draws, int frame);
/// A patch gives some of its edges, and perhaps its past, to a candidate beside it; or takes all of a
/// neighbour's.
std::optional<double> split_or_merge(StateChange& change, ChoiceSource& draws, int frame);

// Whole stretches of curves (move_strokes.cpp).
/// Along a curve, each patch's predecessor becomes its neighbour's.
std::optional<double> shift_links(StateChange& change, ChoiceSource& draws, int frame);
/// All links that lay one stroke onto another, all at once: made or undone.
std::optional<double> link_strokes(StateChange& change, ChoiceSource& draws, int frame);
/// A stroke gets its past from another stroke than before.
std::optional<double> relink_stroke(StateChange& change, ChoiceSource& draws, int frame);

}  // namespace emberfold::mcmc
