// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/moves.hpp"

#include <array>

namespace emberfold::mcmc {

std::span<const Move> moves() {
  static constexpr std::array<Move, 10> all = {{{"link, unlink", link_or_unlink, 2, true},
                                                {"switch", switch_links, 2, true},
                                                {"relink", relink, 2, true},
                                                {"connect, cut", connect_or_cut, 3, false},
                                                {"add, delete", add_or_delete, 2, false},
                                                {"add, delete tracks", add_or_delete_track, 0.3, false, true},
                                                {"split, merge", split_or_merge, 1, false},
                                                {"shift a run", shift_links, 0.5, true},
                                                {"tie strokes", link_strokes, 0.03, true},
                                                {"hand over", relink_stroke, 0.03, true}}};
  return all;
}

}  // namespace emberfold::mcmc
