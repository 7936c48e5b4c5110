// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/skipped_patches.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

// Half axes of the ellipse about the expected place in which partners are looked for, px: patches of a curve
// lie 5 px apart, and links slide along it, so that a neighbour's motion tells little of that along the
// curve.
constexpr double kSlipAlong = 7.5, kSlipAcross = 3;
constexpr double kTurn = 0.5;  // rad

/// A link that could be added, by vertex index.
struct Offer {
  double way = 0;  ///< from where it is expected, in half axes
  Point middle;    ///< with `way`, an order that reversing time keeps
  std::uint32_t before = 0, after = 0;
  [[nodiscard]] auto key() const { return std::tuple(way, middle.x, middle.y); }
};

bool goes_on(const Patch& a, const Patch& b) {
  return same_kind(a, b) && orientation_difference(a.theta, b.theta) < kTurn;
}

/// Offers each unlinked vertex of one frame its nearest partner around those of its neighbours.
/// `forward`: the other frame is the one after it.
void offer_links(const AttributeGraph& here, const AttributeGraph& there,
                 const std::vector<std::vector<std::uint32_t>>& partners, bool forward,
                 std::vector<Offer>& offers) {
  for (std::uint32_t v = 0; v < here.size(); ++v) {
    if (!partners[v].empty()) continue;
    Offer best;
    bool found = false;
    const Point place = here.patch(v).position;
    const Point along{std::cos(here.patch(v).theta), std::sin(here.patch(v).theta)};
    const auto try_partner = [&](Point expected, std::uint32_t w) {
      const Point other = there.patch(w).position;
      const Point apart = other - expected;
      const double way =
          std::hypot(dot(apart, along) / kSlipAlong, (apart.y * along.x - apart.x * along.y) / kSlipAcross);
      const Offer offer{way, (place + other) * 0.5, forward ? v : w, forward ? w : v};
      if (way > 1 || !goes_on(here.patch(v), there.patch(w))) return;
      if (!found || offer.key() < best.key()) best = offer, found = true;
    };
    for (const std::uint32_t beside : here.neighbours(v))
      for (const std::uint32_t partner : partners[beside]) {
        const Point expected = place + there.patch(partner).position - here.patch(beside).position;
        try_partner(expected, partner);
        for (const std::uint32_t w : there.neighbours(partner)) try_partner(expected, w);
      }
    if (found) offers.push_back(best);
  }
}

std::vector<Link> find_skipped(const AttributeGraph& before, const AttributeGraph& after,
                               std::span<const Link> links) {
  detail::LinkPartners partners(detail::index_links(before, after, links));
  std::vector<Link> skipped;
  for (bool grows = true; grows;) {  // those beside newly linked ones come next
    grows = false;
    std::vector<Offer> offers;
    offer_links(before, after, partners.successors, true, offers);
    offer_links(after, before, partners.predecessors, false, offers);
    std::ranges::sort(offers, {}, &Offer::key);
    for (const Offer& offer : offers) {
      if (!partners.admit(offer.before, offer.after)) continue;
      partners.add(offer.before, offer.after);
      skipped.push_back({before.vertices()[offer.before].id, after.vertices()[offer.after].id});
      grows = true;
    }
  }
  std::ranges::sort(skipped);
  return skipped;
}

}  // namespace

void link_skipped_patches(MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  motion.skipped.assign(frames.size(), {});
  for (std::size_t t = 1; t < frames.size(); ++t)
    motion.skipped[t] = find_skipped(frames[t - 1], frames[t], motion.links[t]);
  if (std::ranges::all_of(motion.skipped, [](const auto& links) { return links.empty(); }))
    motion.skipped.clear();
}

}  // namespace emberfold::graph
