// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/editable_graph.hpp"

#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "sketch/refinement/proposals.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;

namespace {

/// A row of patches 5 px apart, each of the given gain.
graph::AttributeGraph row(const std::vector<double>& gains) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t i = 0; i < gains.size(); ++i) {
    graph::Patch patch;
    patch.position = {10 + 5.0 * i, 10};
    patch.width = 2;
    patch.contrast = 50;
    patch.gain = gains[i];
    vertices.push_back({{i}, {}, patch});
    if (i > 0) edges.push_back({{i - 1}, {i}});
  }
  return {std::move(vertices), std::move(edges)};
}

/// A change that fits the draft, drawn at random.
GraphEdit any_edit(const EditableGraph& draft, core::Rng& rng) {
  std::vector<Slot> held;
  for (Slot slot = 0; slot < draft.slots(); ++slot)
    if (draft.holds(slot)) held.push_back(slot);
  GraphEdit edit;
  std::set<Slot> gone;
  for (int i = 0; i < 3 && !held.empty(); ++i) {
    const Slot slot = held[rng.below(static_cast<std::uint32_t>(held.size()))];
    if (rng.uniform(0, 1) < 0.5 && gone.insert(slot).second) remove_patch(edit, draft, slot);
    for (const Slot other : draft.neighbours(slot))
      if (rng.uniform(0, 1) < 0.3 &&
          std::ranges::find(edit.remove_edges, make_edge(slot, other)) == edit.remove_edges.end())
        edit.remove_edges.push_back(make_edge(slot, other));
  }
  std::vector<Slot> there;
  std::ranges::copy_if(held, std::back_inserter(there), [&](Slot s) { return !gone.contains(s); });
  for (Slot i = 0; i < 2; ++i) {
    graph::Patch patch;
    patch.gain = rng.uniform(-5, 20);
    edit.add_patches.emplace_back(draft.slots() + i, patch);
    there.push_back(draft.slots() + i);
  }
  for (int i = 0; i < 4; ++i) {
    const Slot a = there[rng.below(static_cast<std::uint32_t>(there.size()))],
               b = there[rng.below(static_cast<std::uint32_t>(there.size()))];
    if (a == b || std::ranges::find(edit.add_edges, make_edge(a, b)) != edit.add_edges.end()) continue;
    const bool tied = a < draft.slots() && std::ranges::count(draft.neighbours(a), b) > 0;
    if (!tied) edit.add_edges.push_back(make_edge(a, b));
  }
  return edit;
}

std::string refusal(EditableGraph& draft, const GraphEdit& edit) {
  return test::message_of<core::InputError>([&] { draft.apply(edit); });
}

}  // namespace

TEST_CASE("A draft's length is its degrees' cost without its patches' gains") {
  const EditableGraph draft(row({7, 11, 2}));
  CHECK_THAT(draft.length(), WithinAbs(3 + 0 + 3 - 20, 1e-12));
  CHECK(EditableGraph(graph::AttributeGraph()).length() == 0);
  CHECK(degree_cost(1) > degree_cost(3));
  CHECK(degree_cost(7) == degree_cost(4));
}

TEST_CASE("Any edit changes the length by what it says and its reverse restores the draft") {
  core::Rng rng(7);
  EditableGraph draft(row({3, 4, 5, 6, 7, 8, 9, 10}));
  for (int i = 0; i < 2000; ++i) {
    const EditableGraph before = draft;
    const GraphEdit edit = any_edit(draft, rng);
    const double told = draft.change(edit);
    const GraphEdit reverse = draft.apply(edit);
    REQUIRE_THAT(draft.length() - before.length(), WithinAbs(told, 1e-9));
    EditableGraph back = draft;
    REQUIRE_THAT(back.change(reverse), WithinAbs(-told, 1e-9));
    back.apply(reverse);
    REQUIRE(back == before);
    if (draft.slots() > 60) draft = before;
  }
}

TEST_CASE("Edits that do not fit are refused and change nothing") {
  EditableGraph draft(row({1, 2, 3}));
  const EditableGraph before = draft;
  CHECK(refusal(draft, {{{0, 2}}, {}, {}, {}}).find("cuts an edge that is not there") != std::string::npos);
  CHECK(refusal(draft, {{}, {1}, {}, {}}).find("but not its edge") != std::string::npos);
  CHECK(refusal(draft, {{}, {9}, {}, {}}).find("not there at slot 9") != std::string::npos);
  CHECK(refusal(draft, {{}, {}, {{1, {}}}, {}}).find("over another") != std::string::npos);
  CHECK(refusal(draft, {{}, {}, {}, {{0, 1}}}).find("cannot be tied") != std::string::npos);
  CHECK(refusal(draft, {{}, {}, {}, {{0, 7}}}).find("cannot be tied") != std::string::npos);
  CHECK(refusal(draft, {{{0, 1}, {1, 2}}, {1}, {}, {{0, 1}}}).find("cannot be tied") != std::string::npos);
  CHECK(draft == before);
}

TEST_CASE("Every proposal for a frame is worth what counting anew says and can be undone") {
  const cv::Size size(160, 120);
  cv::Mat1f clean = draw(size,
                         {segment({15, 20}, {70, 24}, 3, 1), segment({84, 25}, {140, 30}, 3, 1),
                          segment({20, 50}, {60, 50}, 4, 1.2), segment({62, 54}, {62, 100}, 4, 1.2),
                          segment({90, 60}, {150, 60}, 14, 1), segment({100, 95}, {108, 96}, 4, 1.5),
                          segment({120, 80}, {140, 110}, 3, 1)},
                         60, 90);
  const cv::Mat1f frame = with_noise(clean, 6, 3);
  const CodingContext prepared = prepare_coding(frame);
  // The extracted sketch without some patches, so that every edit has something to do.
  const graph::AttributeGraph found = extract(frame, {});
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const graph::Vertex& v : found.vertices())
    if (v.id.value % 7 != 3) vertices.push_back(v);
  for (const graph::Edge& e : found.edges())
    if (e.a.value % 7 != 3 && e.b.value % 7 != 3) edges.push_back(e);
  const EditableGraph draft(graph::AttributeGraph(std::move(vertices), std::move(edges)));
  sketch::FitCache cache;
  ProposalBuilder editor(draft, frame, {&prepared, 1}, {5}, cache);
  propose_for_strokes(editor);
  propose_at_ends(editor);
  propose_meetings(editor);
  const std::vector<Proposal> proposals = editor.take_proposals();
  REQUIRE(proposals.size() >= 15);
  for (const Proposal& proposal : proposals) {
    EditableGraph edited = draft;
    const GraphEdit reverse = edited.apply(proposal.edit);
    CHECK_THAT(edited.length() - draft.length(), WithinAbs(proposal.change, 1e-9));
    CHECK(proposal.change < 0);
    for (const auto& [slot, patch] : proposal.edit.add_patches)
      CHECK(patch.gain == coding_gain(prepared, patch));
    edited.apply(reverse);
    CHECK(edited == draft);
  }
}
