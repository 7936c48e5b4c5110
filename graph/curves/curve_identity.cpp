// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_identity.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/parallel.hpp"
#include "graph/curves/curve_pieces.hpp"
#include "graph/curves/curve_union.hpp"
#include "graph/curves/joint_tracks.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::graph {

namespace {

using detail::kNoIndex;

constexpr std::size_t kMemory = 12;        // frames before that a piece takes its identity from
constexpr double kFading = 0.8;            // weight of a frame against the next
constexpr std::uint32_t kLeastLinks = 2;   // patches that carry an identity on, and
constexpr double kShareOfPiece = 1.0 / 3;  // of the patches of the piece
constexpr int kSettlings = 2;              // times that pieces look at the frames around them

/// Visits the patches that a patch of frame t was, or becomes if `forward`: visit(frame, patch, weight) for
/// up to kMemory frames, the nearest first and of weight 1.
template <class Visit>
void follow_patch(const detail::ClipArcs& clip, std::size_t t, std::uint32_t v, bool forward,
                  const Visit& visit) {
  double weight = 1;
  for (std::size_t k = 0; k < kMemory && (forward ? t + 1 < clip.frames.size() : t > 0); ++k) {
    v = forward ? clip.after[t][v] : clip.before[t][v];
    if (v == kNoIndex) return;
    t = forward ? t + 1 : t - 1;
    visit(t, v, weight);
    weight *= kFading;
  }
}

/// Follows the pieces of the frames through time: each takes, one to one, the identity that most of its
/// patches had in the frames before.
detail::Identities follow_pieces(const detail::ClipArcs& clip,
                                 const std::vector<detail::FramePieces>& pieces) {
  detail::Identities identity(pieces.size());
  std::uint32_t last = 0;
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    const auto& piece = pieces[t].of_vertex;
    struct Vote {
      double weight = 0;
      std::uint32_t links = 0;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, Vote> votes;  // (identity, piece)
    std::vector<std::uint32_t> size(pieces[t].count, 0), id(pieces[t].count, 0);
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
      ++size[piece[v]];
      follow_patch(clip, t, v, false, [&](std::size_t s, std::uint32_t u, double weight) {
        Vote& vote = votes[{identity[s][u], piece[v]}];
        vote.weight += weight, ++vote.links;
      });
    }
    std::vector<Candidate> gains;
    for (const auto& [pair, vote] : votes) {
      if (vote.links >= kLeastLinks && vote.weight >= kShareOfPiece * size[pair.second])
        gains.push_back({pair.first, pair.second, vote.weight});
    }
    for (const auto& [known, p] : assign(gains)) id[p] = known;
    for (std::uint32_t& i : id)
      if (i == 0) i = ++last;
    for (const std::uint32_t p : piece) identity[t].push_back(id[p]);
  }
  return identity;
}

/// Gives each piece the identity that most of its patches have in this frame and those before and after it.
void settle(const detail::ClipArcs& clip, const std::vector<detail::FramePieces>& pieces,
            detail::Identities& identity) {
  const detail::Identities now = identity;
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    const auto& piece = pieces[t].of_vertex;
    std::vector<std::map<std::uint32_t, double>> votes(pieces[t].count);
    for (std::uint32_t v = 0; v < piece.size(); ++v) {
      votes[piece[v]][now[t][v]] += 1;
      for (const bool forward : {false, true})
        follow_patch(clip, t, v, forward, [&](std::size_t s, std::uint32_t u, double weight) {
          votes[piece[v]][now[s][u]] += kFading * weight;
        });
    }
    std::vector<std::uint32_t> most;
    for (const auto& of_piece : votes)
      most.push_back(
          std::ranges::max_element(of_piece, {}, [](const auto& vote) { return vote.second; })->first);
    for (std::uint32_t v = 0; v < piece.size(); ++v) identity[t][v] = most[piece[v]];
  }
}

/// Numbers the identities from 1 in order of appearance.
void renumber(detail::Identities& identity) {
  std::map<std::uint32_t, std::uint32_t> number;
  for (auto& frame : identity)
    for (std::uint32_t& i : frame)
      i = number.emplace(i, static_cast<std::uint32_t>(number.size() + 1)).first->second;
}

void add_joints(const detail::FrameArcs& frame, const std::vector<detail::TimedJoint>& found,
                const std::vector<double>& probability, const std::vector<std::uint32_t>& identity, int t,
                std::vector<CurveJoint>& joints) {
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto ways = detail::ways_from(frame, found[k].site, 0);
    const std::uint32_t a = ways.a.front(), b = ways.b.front();
    const auto [low, high] = std::minmax(identity[a], identity[b]);
    joints.push_back(
        {t, (frame.at(a) + frame.at(b)) * 0.5, {low}, {high}, probability[k], found[k].site.at_knot()});
  }
}

}  // namespace

CurveGrouping identify_curves(MotionGraph motion, const core::Context& context) {
  validate(motion);
  const detail::ClipArcs clip = detail::clip_arcs(motion, context);
  const detail::JointScales scales = detail::measure_scales(clip.frames);
  const auto joints = detail::follow_joints(clip, scales, context);
  std::vector<detail::FramePieces> pieces(joints.size());
  core::parallel_for(joints.size(), context,
                     [&](std::size_t t) { pieces[t] = detail::divide_frame(clip.frames[t], joints[t]); });
  detail::Identities identity = follow_pieces(clip, pieces);
  detail::unite_identities(clip, joints, scales, identity);
  for (int k = 0; k < kSettlings; ++k) settle(clip, pieces, identity);
  renumber(identity);
  CurveGrouping result;
  for (std::size_t t = 0; t < joints.size(); ++t)
    add_joints(clip.frames[t], joints[t], pieces[t].probability, identity[t], static_cast<int>(t),
               result.joints);
  for (std::size_t t = 0; t < joints.size(); ++t) {
    std::vector<CurveId> curves;
    for (const std::uint32_t i : identity[t]) curves.push_back({i});
    motion.sketch.frames[t] = motion.sketch.frames[t].with_curves(curves);
  }
  result.motion = std::move(motion);
  return result;
}

}  // namespace emberfold::graph
