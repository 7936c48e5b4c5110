// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.hpp"
#include "mcmc/model/motion_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using core::ModelArchive;
using core::NpyArray;

namespace {

// Puts `by` in place of the first `what`.
void replace(std::string& text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("no " + what + " in the text");
  text.replace(at, what.size(), by);
}

std::string refusal(const ModelArchive& archive) {
  return test::message_of<core::IoError>([&] { (void)mcmc::motion_model(archive); });
}

std::vector<double>& reals(ModelArchive& archive, const std::string& name) {
  return std::get<std::vector<double>>(archive.arrays.at(name).data);
}

std::vector<std::int64_t>& whole(ModelArchive& archive, const std::string& name) {
  return std::get<std::vector<std::int64_t>>(archive.arrays.at(name).data);
}

struct Broken {
  std::string names;  // a part that the message names
  std::function<void(ModelArchive&)> breaking;
};

void check_refused(const std::vector<Broken>& table) {
  for (const auto& [names, breaking] : table) {
    auto archive = mcmc::to_archive(test::full_model());
    breaking(archive);
    const auto message = refusal(archive);
    CAPTURE(names, message);
    CHECK(test::contains(message, "motion model"));
    CHECK(test::contains(message, names));
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 300);
  }
}

}  // namespace

TEST_CASE("A model comes back from its archive", "[archive]") {
  for (const auto& model : {test::full_model(), test::empty_model()}) {
    const auto archive = mcmc::to_archive(model);
    const auto again = mcmc::motion_model(archive);
    CHECK(again == model);
    const auto twice = mcmc::to_archive(again);
    CHECK(twice.text == archive.text);
    CHECK(twice.arrays == archive.arrays);
  }
}

TEST_CASE("Every number of a model is in its archive", "[archive]") {
  // A change of any one of them changes what is written.
  const auto model = test::full_model();
  const auto archive = mcmc::to_archive(model);
  std::vector<std::function<void(mcmc::MotionModel&)>> changes{
      [](auto& m) { m.fps += 1; },
      [](auto& m) { m.frames += 1; },
      [](auto& m) { m.displacement.range += 1; },
      [](auto& m) { m.displacement.measurement += 0.1; },
      [](auto& m) { m.contrast.a2 += 0.01; },
      [](auto& m) { m.contrast.coupling += 0.01; },
      [](auto& m) { m.rates.birth.values[1] += 1e-6; },
      [](auto& m) { m.rates.death_by_size[6] += 0.01; },
      [](auto& m) { m.rates.merge += 0.01; },
      [](auto& m) { m.rates.disconnect_gap += 1; },
      [](auto& m) { m.rates.refractory_period += 1; },
      [](auto& m) { m.rates.modifiers.death[0] += 0.1; },
      [](auto& m) { m.rates.modifiers.separation[1] += 0.1; },
      [](auto& m) { m.rates.modifiers.unification[2] += 0.1; },
      [](auto& m) { m.rates.modifiers.bridging[3] += 0.1; },
      [](auto& m) { m.rates.modifiers.turning[2] += 0.1; },
      [](auto& m) { m.rates.modifiers.pace += 0.1; },
      [](auto& m) { m.hard_core.alike += 1; },
      [](auto& m) { m.hard_core.lines += 1; },
      [](auto& m) { m.hard_core.mixed += 1; },
      [](auto& m) { m.vanishing[7] -= 0.01; },
      [](auto& m) { m.displacement_scale.values[3] += 0.1; },
      [](auto& m) { m.velocity.modes[5] += 0.1; },
      [](auto& m) { std::swap(m.velocity.step, m.velocity.noise); },
      [](auto& m) { m.velocity = {}; },
      [](auto& m) { m.exemplars[1].clearance += 1; },
      [](auto& m) { m.exemplars.pop_back(); },
      [](auto& m) { m.first = {}; }};
  for (const auto& change : changes) {
    auto other = model;
    change(other);
    const auto changed = mcmc::to_archive(other);
    CHECK((changed.text != archive.text || changed.arrays != archive.arrays));
    CHECK(mcmc::motion_model(changed) == other);
  }
}

TEST_CASE("Patch types keep the numbers that they had in older models, and 4 is none", "[archive]") {
  auto model = test::full_model();
  const auto first_of_type = [&model](graph::PatchType type) {
    std::vector<graph::Vertex> vertices(model.first.vertices().begin(), model.first.vertices().end());
    vertices[0].patch.type = type;
    model.first = {std::move(vertices), {model.first.edges().begin(), model.first.edges().end()}};
    return mcmc::to_archive(model);
  };
  const auto number_in = [](auto& archive) -> double& {
    return std::get<std::vector<double>>(archive.arrays.at("first_patches").data)[15];
  };
  using enum graph::PatchType;
  for (const auto& [type, number] :
       {std::pair{ridge, 0.0}, {step, 3.0}, {corner, 5.0}, {terminator, 6.0}, {crossing, 10.0}}) {
    auto archive = first_of_type(type);
    CHECK(number_in(archive) == number);
    CHECK(mcmc::motion_model(archive) == model);
    // Double ridges had 4.
    for (const double none : {4.0, -1.0, 4.5, 11.0, std::nan("")}) {
      number_in(archive) = none;
      CHECK(test::contains(refusal(archive), "first_patches.npy holds a"));
    }
  }
}

TEST_CASE("A model holds no anchors", "[archive]") {
  auto model = test::full_model();
  model.first = {{{{0}, {}, graph::make_anchor({3, 4}, {1, 2, 3})}}, {}};
  CHECK(test::contains(test::message_of<core::InputError>([&] { mcmc::to_archive(model); }), "an anchor"));
}

TEST_CASE("An archive without one of its arrays is refused", "[archive]") {
  const auto archive = mcmc::to_archive(test::full_model());
  REQUIRE(archive.arrays.size() == 16);
  for (const auto& [name, array] : archive.arrays) {
    auto broken = archive;
    broken.arrays.erase(name);
    CHECK(test::contains(refusal(broken), name + ".npy is missing"));
  }
}

TEST_CASE("An archive with an array of another shape or type is refused", "[archive]") {
  const auto archive = mcmc::to_archive(test::full_model());
  for (const auto& [name, array] : archive.arrays) {
    const auto refused_as = [&, &name = name](const NpyArray& other) {
      auto broken = archive;
      broken.arrays[name] = other;
      const auto message = refusal(broken);
      CAPTURE(name, message);
      CHECK(test::contains(message, name + ".npy"));
    };
    CAPTURE(name);
    NpyArray other = array;
    std::swap(other.shape[0], other.shape[1]);
    if (other.shape != array.shape) refused_as(other);
    other = array;
    other.shape = {array.shape[0] * array.shape[1]};
    refused_as(other);
    other = array;
    other.shape.push_back(1);
    refused_as(other);
    other = array;
    other.shape.clear();
    refused_as(other);
    other = array;
    other.fortran_order = true;
    refused_as(other);
    refused_as({array.shape, false, std::vector<float>(array.shape[0] * array.shape[1])});
    const bool is_real = std::holds_alternative<std::vector<double>>(array.data);
    if (is_real)
      refused_as({array.shape, false, std::vector<std::int64_t>(array.shape[0] * array.shape[1])});
    else
      refused_as({array.shape, false, std::vector<double>(array.shape[0] * array.shape[1])});
  }
}

TEST_CASE("An archive with a number that is none is refused", "[archive]") {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const auto& [name, names] :
         std::map<std::string, std::string>{{"birth", "birth map"},
                                            {"death", "death map"},
                                            {"density", "density map"},
                                            {"parting", "parting map"},
                                            {"sway_share", "sway_share"},
                                            {"drift_x", "drift_x"},
                                            {"drift_y", "drift_y"},
                                            {"velocity_modes", "velocity_modes"},
                                            {"velocity_step", "velocity_modes"},
                                            {"velocity_noise", "velocity_modes"},
                                            {"exemplar_places", "exemplar"},
                                            {"exemplar_patches", "exemplar_patches"},
                                            {"first_patches", "first_patches"}})
      check_refused({{names, [bad, &name = name](ModelArchive& a) { reals(a, name).back() = bad; }},
                     {names, [bad, &name = name](ModelArchive& a) { reals(a, name)[1] = bad; }}});
}

TEST_CASE("A model.json that is none of this version is refused", "[archive]") {
  const auto text = [](const std::string& what, const std::string& by) {
    return [=](ModelArchive& a) { replace(a.text, what, by); };
  };
  check_refused({
      {"version 2", text("\"version\": 1", "\"version\": 2")},
      {"version 0", text("\"version\": 1", "\"version\": 0")},
      {"version", text("\"version\": 1", "\"version\": 1.5")},
      {"version", text("\"version\": 1", "\"version\": \"1\"")},
      {"emberfold.motion_model", text("emberfold.motion_model", "emberfold.dynamic_texture")},
      {"emberfold.motion_model", text("\"format\"", "\"what\"")},
      {"model.json", [](ModelArchive& a) { a.text.clear(); }},
      {"model.json", [](ModelArchive& a) { a.text = "[1, 2]"; }},
      {"model.json", [](ModelArchive& a) { a.text.resize(a.text.size() / 2); }},
      {"model.json", [](ModelArchive& a) { a.text.resize(a.text.size() - 2); }},
      {"model.json", [](ModelArchive& a) { a.text = std::string(100000, '['); }},
      {"model.json", text("\"fps\": ", "\"fps\": 1e999, \"x\": ")},
  });
  // Cut off anywhere it is refused, and never reads as another model.
  const auto archive = mcmc::to_archive(test::full_model());
  for (std::size_t size = 0; size + 2 < archive.text.size(); size += 7) {
    auto broken = archive;
    broken.text.resize(size);
    CHECK(test::contains(refusal(broken), "motion model"));
  }
}

TEST_CASE("A model.json with a value missing or of another type is refused", "[archive]") {
  const std::vector<std::string> keys{"width",
                                      "height",
                                      "fps",
                                      "frames",
                                      "sway",
                                      "contrast",
                                      "cell",
                                      "rates",
                                      "appearing",
                                      "vanishing",
                                      "a1",
                                      "a2",
                                      "coupling",
                                      "noise",
                                      "range",
                                      "measurement",
                                      "birth_by_size",
                                      "death_by_size",
                                      "split",
                                      "merge",
                                      "connect",
                                      "disconnect",
                                      "reach",
                                      "split_gap",
                                      "disconnect_gap",
                                      "parting",
                                      "uniting",
                                      "bridging",
                                      "pace"};
  for (const auto& key : keys)
    check_refused(
        {{key, [&](ModelArchive& a) { replace(a.text, "\"" + key + "\":", "\"renamed\":"); }},
         {key,
          [&](ModelArchive& a) { replace(a.text, "\"" + key + "\":", "\"" + key + "\": null, \"old\":"); }},
         {key,
          [&](ModelArchive& a) { replace(a.text, "\"" + key + "\":", "\"" + key + "\": \"7\", \"old\":"); }},
         {key,
          [&](ModelArchive& a) { replace(a.text, "\"" + key + "\":", "\"" + key + "\": [7], \"old\":"); }}});
}

TEST_CASE("A model out of its ranges is refused, from an archive and into one", "[archive]") {
  struct Case {
    std::string names;
    std::function<void(mcmc::MotionModel&)> breaking;
  };
  const std::vector<Case> table{
      {"frame", [](auto& m) { m.width = 0; }},
      {"frame", [](auto& m) { m.height = 70000; }},
      {"fps", [](auto& m) { m.fps = 0; }},
      {"fps", [](auto& m) { m.fps = std::nan(""); }},
      {"frames", [](auto& m) { m.frames = 1; }},
      {"sway", [](auto& m) { m.displacement.a1 = 1.5, m.displacement.a2 = -0.2; }},
      {"sway", [](auto& m) { m.displacement.noise = -1; }},
      {"sway", [](auto& m) { m.displacement.noise = std::nan(""); }},
      {"sway", [](auto& m) { m.displacement.range = -1; }},
      {"contrast", [](auto& m) { m.contrast.a2 = -1; }},
      {"contrast", [](auto& m) { m.contrast.coupling = 1.5; }},
      {"birth map", [](auto& m) { m.rates.birth.values[0] = -1; }},
      {"birth map", [](auto& m) { m.rates.birth.values.pop_back(); }},
      {"death map", [](auto& m) { m.rates.death.columns += 1; }},
      {"density", [](auto& m) { m.density.cell = 0; }},
      {"birth map", [](auto& m) { m.rates.birth = test::map_over(m.width, m.height, 32, 1e-5); }},
      {"births", [](auto& m) { m.rates.birth_by_size[0] = 2; }},
      {"death", [](auto& m) { m.rates.death_by_size[3] = -0.1; }},
      {"velocity_modes", [](auto& m) { m.velocity.step[0] = 0.7; }},
      {"velocity_modes", [](auto& m) { m.velocity.noise[2] = 0.1; }},
      {"velocity_modes", [](auto& m) { m.velocity.modes.pop_back(); }},
      {"split", [](auto& m) { m.rates.split = 1.1; }},
      {"merge", [](auto& m) { m.rates.merge = std::nan(""); }},
      {"connect", [](auto& m) { m.rates.connect = -1; }},
      {"disconnect", [](auto& m) { m.rates.disconnect = 2; }},
      {"gap", [](auto& m) { m.rates.reach = 1e5; }},
      {"circumstances", [](auto& m) { m.rates.modifiers.death[3] = -1; }},
      {"circumstances", [](auto& m) { m.rates.modifiers.bridging[5] = std::nan(""); }},
      {"circumstances", [](auto& m) { m.rates.modifiers.turning[1] = -0.5; }},
      {"pace", [](auto& m) { m.rates.modifiers.pace = 0; }},
      {"exclusion", [](auto& m) { m.hard_core.lines = -1; }},
      {"exclusion", [](auto& m) { m.hard_core.mixed = std::nan(""); }},
      {"appearing", [](auto& m) { m.appearing[2] = 1.5; }},
      {"vanishing", [](auto& m) { m.vanishing[2] = -0.5; }},
      {"exemplar", [](auto& m) { m.exemplars[0].graph = {}; }},
      {"exemplar", [](auto& m) { m.exemplars[0].place.x = std::nan(""); }},
      {"exemplar", [](auto& m) { m.exemplars[0].clearance = -1; }},
      {"exemplar",
       [](auto& m) {
         // The writer refuses a graph that no reader accepts.
         test::Frame frame;
         frame.line({{2e6, 0}, {5, 0}});
         m.exemplars[0].graph = frame.graph();
       }},
      {"first",
       [](auto& m) {
         test::Frame frame;
         frame.line({{0, 0}, {5, -3e6}});
         m.first = frame.graph();
       }},
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    auto model = test::full_model();
    table[i].breaking(model);
    const auto message = test::message_of<core::InputError>([&] { mcmc::validate(model); });
    CAPTURE(i, table[i].names, message);
    CHECK(test::contains(message, table[i].names));
    CHECK(test::message_of<core::InputError>([&] { (void)mcmc::to_archive(model); }) == message);
  }
  const auto text = [](const std::string& what, const std::string& by) {
    return [=](ModelArchive& a) { replace(a.text, what, by); };
  };
  check_refused({
      {"sway is not stable", text("\"a1\": ", "\"a1\": 2.5, \"old\": ")},
      {"width", text("\"width\": ", "\"width\": 1.5, \"old\": ")},
      {"width", text("\"width\": ", "\"width\": -3, \"old\": ")},
      {"frame is", text("\"width\": ", "\"width\": 70000, \"old\": ")},
      {"height", text("\"height\": ", "\"height\": 1e12, \"old\": ")},
      {"birth.npy", text("\"width\": ", "\"width\": 1000, \"old\": ")},
      {"cell", text("\"cell\": ", "\"cell\": 0, \"old\": ")},
      {"cell", text("\"cell\": ", "\"cell\": -16, \"old\": ")},
      {"birth.npy", text("\"cell\": ", "\"cell\": 8, \"old\": ")},
      {"merge rate", text("\"merge\": ", "\"merge\": 3, \"old\": ")},
      {"fps", text("\"fps\": ", "\"fps\": 1e300, \"old\": ")},
  });
}

TEST_CASE("An archive whose sizes and edges do not fit is refused", "[archive]") {
  check_refused({
      {"exemplar_edges", [](ModelArchive& a) { whole(a, "exemplar_edges")[0] = -1; }},
      {"exemplar_edges", [](ModelArchive& a) { whole(a, "exemplar_edges")[1] = 1000; }},
      {"exemplar_edges",
       [](ModelArchive& a) { whole(a, "exemplar_edges")[1] = std::numeric_limits<std::int64_t>::max(); }},
      {"exemplar_edges",
       [](ModelArchive& a) { whole(a, "exemplar_edges")[1] = whole(a, "exemplar_edges")[0]; }},
      {"exemplar_edges",
       [](ModelArchive& a) {
         auto& edges = whole(a, "exemplar_edges");
         edges[2] = edges[0], edges[3] = edges[1];  // an edge twice
       }},
      {"first_edges", [](ModelArchive& a) { whole(a, "first_edges")[0] = 1 << 20; }},
      {"exemplar_sizes", [](ModelArchive& a) { whole(a, "exemplar_sizes")[0] = 0; }},
      {"exemplar_sizes", [](ModelArchive& a) { whole(a, "exemplar_sizes")[1] = -1; }},
      {"exemplar_patches", [](ModelArchive& a) { whole(a, "exemplar_sizes")[2] += 1; }},
      {"exemplar_edges", [](ModelArchive& a) { whole(a, "exemplar_sizes")[2] -= 1; }},
      {"exemplar_edges", [](ModelArchive& a) { whole(a, "exemplar_sizes")[3] -= 1; }},
      {"exemplar_patches",
       [](ModelArchive& a) { whole(a, "exemplar_sizes")[0] = std::numeric_limits<std::int64_t>::max(); }},
      {"exemplar_edges",
       [](ModelArchive& a) { whole(a, "exemplar_sizes")[1] = std::numeric_limits<std::int64_t>::max(); }},
      {"exemplar_places",
       [](ModelArchive& a) {
         auto& places = a.arrays["exemplar_places"];
         places.shape[0] -= 1;
         reals(a, "exemplar_places").resize(3 * places.shape[0]);
       }},
      {"first_patches", [](ModelArchive& a) { reals(a, "first_patches")[15] = 99; }},
      {"first_patches", [](ModelArchive& a) { reals(a, "first_patches")[15] = 0.5; }},
      {"first_patches", [](ModelArchive& a) { reals(a, "first_patches")[3] = -1; }},
      {"first_patches", [](ModelArchive& a) { reals(a, "first_patches")[0] = 1e7; }},
      {"first_patches", [](ModelArchive& a) { reals(a, "first_patches")[8] = 1e300; }},
  });
}
