// SPDX-License-Identifier: Apache-2.0
// A GEFF against what the format and the programs that read it ask for:
// - format: geff-spec, https://liveimagetrackingtools.org/geff (metadata, axes, arrays of nodes and edges);
// - traccuracy, loaders/_geff.py and _tracking_graph.py: the axis of type time is the number of the frame;
// - motile tracker (funtracks, import_export/_validation.py): one graph, without repeated or looped edges.
#include <cstring>
#include <map>
#include <ostream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "graph/exporting/tracking_files.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/merging_strokes.hpp"

using namespace emberfold;
using Json = nlohmann::json;

namespace {

/// The files of a GEFF in memory.
class Geff {
 public:
  Geff(const graph::StrokeTree& tree, const graph::Units& units) {
    graph::write_geff(tree, {"clip", 320, 240, 4, 25, units}, "run.geff",
                      [&](const std::string& path, const std::function<void(std::ostream&)>& body) {
                        std::ostringstream out;
                        body(out);
                        files_[path] = out.str();
                      });
  }
  [[nodiscard]] Json json(const std::string& path) const {
    return Json::parse(files_.at("run.geff/" + path));
  }
  [[nodiscard]] Json about() const { return json(".zattrs").at("geff"); }
  [[nodiscard]] bool holds(const std::string& path) const { return files_.contains("run.geff/" + path); }

  /// Returns the values of an array of one chunk.
  template <class Value>
  [[nodiscard]] std::vector<Value> values(const std::string& path) const {
    const Json shape = json(path + "/.zarray").at("shape");
    if (shape[0] == 0) return {};
    const std::string& bytes = files_.at("run.geff/" + path + (shape.size() == 2 ? "/0.0" : "/0"));
    std::vector<Value> result(bytes.size() / sizeof(Value));
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
  [[nodiscard]] std::vector<std::pair<std::uint64_t, std::uint64_t>> edges() const {
    const auto flat = values<std::uint64_t>("edges/ids");
    std::vector<std::pair<std::uint64_t, std::uint64_t>> result;
    for (std::size_t k = 0; k + 1 < flat.size(); k += 2) result.emplace_back(flat[k], flat[k + 1]);
    return result;
  }

 private:
  std::map<std::string, std::string> files_;
};

Geff exported(const graph::Units& units = {}) {
  return {graph::make_stroke_tree(test::two_become_one(), {test::merge_with(0.75)}), units};
}

const std::set<std::string> kTypes = {"<i8", "<u8", "<f8"};

/// Checks the arrays of nodes or edges against their metadata.
void check_part(const Geff& geff, const std::string& part, std::size_t count) {
  CAPTURE(part);
  CHECK(geff.json(part + "s/.zgroup").at("zarr_format") == 2);
  CHECK(geff.json(part + "s/props/.zgroup").at("zarr_format") == 2);
  const Json props = geff.about().at(part + "_props_metadata");
  for (const auto& [name, about] : props.items()) {
    CAPTURE(name);
    CHECK(about.at("identifier") == name);
    std::string place = part;
    place.append("s/props/").append(name).append("/values/.zarray");
    const Json array = geff.json(place);
    CHECK(array.at("shape") == Json::array({count}));
    CHECK(kTypes.contains(array.at("dtype").get<std::string>()));
    const std::string kind = array.at("dtype").get<std::string>().substr(1, 1);
    CHECK(about.at("dtype") == (kind == "f" ? "float64" : kind == "i" ? "int64" : "uint64"));
  }
}

/// Checks one axis: a property of the nodes, with both limits, and a scaled unit only with a scale.
void check_axis(const Json& axis, const Json& node_props) {
  CAPTURE(axis.dump());
  CHECK(node_props.contains(axis.at("name").get<std::string>()));
  CHECK(std::set<std::string>{"space", "time"}.contains(axis.at("type").get<std::string>()));
  CHECK(axis.contains("min") == axis.contains("max"));
  if (axis.contains("min")) CHECK(axis.at("min").get<double>() <= axis.at("max").get<double>());
  if (axis.contains("scaled_unit")) CHECK(axis.at("scale").is_number());
}

}  // namespace

TEST_CASE("A GEFF has the metadata and the arrays that its format asks for", "[graph][exporting]") {
  graph::Units known;
  known.um = 0.5, known.seconds = 0.2;
  for (const auto& units : {graph::Units{}, known}) {
    const Geff geff = exported(units);
    const Json about = geff.about();
    CHECK(std::regex_search(about.at("geff_version").get<std::string>(), std::regex(R"(^\d+\.\d+(\.\d+)?)")));
    CHECK(about.at("directed") == true);
    CHECK(geff.json(".zgroup").at("zarr_format") == 2);
    std::set<std::string> names;
    for (const auto& axis : about.at("axes")) {
      check_axis(axis, about.at("node_props_metadata"));
      names.insert(axis.at("name"));
    }
    CHECK(names.size() == about.at("axes").size());
    for (const auto& [hint, name] : about.at("display_hints").items()) CHECK(names.contains(name));
    check_part(geff, "node", 6);
    check_part(geff, "edge", 5);
    CHECK(geff.json("nodes/ids/.zarray").at("dtype") == geff.json("edges/ids/.zarray").at("dtype"));
    CHECK(geff.json("edges/ids/.zarray").at("shape") == Json::array({5, 2}));
    CHECK_FALSE(geff.holds("nodes/props/t/missing"));  // axes have a value at every node
  }
}

TEST_CASE("traccuracy and motile read a GEFF: whole frames, forwards, one graph", "[graph][exporting]") {
  graph::Units units;
  units.um = 0.5, units.seconds = 0.2;
  const Geff geff = exported(units);
  const Json about = geff.about();
  std::vector<std::string> time, space;
  for (const auto& axis : about.at("axes"))
    (axis.at("type") == "time" ? time : space).push_back(axis.at("name"));
  CHECK(time == std::vector<std::string>{"t"});
  CHECK(space == std::vector<std::string>{"y", "x"});

  // Two strokes in frames 0 and 1, one in 2 and 3; its middle at (25, 50) px.
  CHECK(geff.json("nodes/props/t/values/.zarray").at("dtype") == "<i8");
  const auto t = geff.values<std::int64_t>("nodes/props/t/values");
  CHECK(t == std::vector<std::int64_t>{0, 1, 0, 1, 2, 3});
  CHECK(geff.values<double>("nodes/props/x/values").back() == Approx(12.5));
  CHECK(geff.values<double>("nodes/props/y/values").back() == Approx(25));
  const Json axis = about.at("axes")[0];
  CHECK(axis.at("unit") == "frame");
  CHECK(axis.at("scale") == 0.2);
  CHECK(axis.at("scaled_unit") == "second");
  CHECK(axis.at("min") == 0);
  CHECK(axis.at("max") == 3);

  const auto ids = geff.values<std::uint64_t>("nodes/ids");
  CHECK(std::set<std::uint64_t>(ids.begin(), ids.end()).size() == ids.size());
  const auto edges = geff.edges();
  CHECK(std::set(edges.begin(), edges.end()) ==
        std::set<std::pair<std::uint64_t, std::uint64_t>>{{0, 1}, {2, 3}, {4, 5}, {1, 4}, {3, 4}});
  CHECK(edges.size() == 5);
  for (const auto& [from, to] : edges) CHECK(t[from] < t[to]);
  for (const auto& [name, prop] : about.at("node_props_metadata").items())
    CHECK_FALSE(about.at("edge_props_metadata").contains(name));
}

TEST_CASE("A GEFF of a part of a clip whose frames are not evenly spaced counts from the source",
          "[graph][exporting]") {
  const Geff geff = exported({0.2, 0.5, {1, 1.1, 1.3, 1.6}, {10, 20, 1, "source"}});
  CHECK(geff.about().at("axes")[0].at("offset") == 1);
  CHECK(geff.values<double>("nodes/props/time_s/values") == std::vector<double>{1, 1.1, 1, 1.1, 1.3, 1.6});
  CHECK(geff.values<double>("nodes/props/x/values").back() == Approx(17.5));
  CHECK(geff.values<double>("nodes/props/y/values").back() == Approx(35));
}

TEST_CASE("A GEFF without a known rate has frames, pixels and no scale; one without strokes is whole",
          "[graph][exporting]") {
  const Json axes = exported().about().at("axes");
  CHECK(axes[0].at("unit") == "frame");
  CHECK_FALSE(axes[0].contains("scale"));
  CHECK_FALSE(axes[0].contains("scaled_unit"));
  CHECK(axes[1].at("unit") == "pixel");
  const Geff empty({}, {});
  CHECK(empty.json("nodes/ids/.zarray").at("shape") == Json::array({0}));
  CHECK(empty.json("edges/ids/.zarray").at("shape") == Json::array({0, 2}));
  CHECK_FALSE(empty.about().at("axes")[0].contains("min"));
}
