// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <ostream>
#include <vector>

#include "core/text/escape_html.hpp"
#include "core/text/format_number.hpp"
#include "graph/exporting/tracking_files.hpp"

namespace emberfold::graph {

namespace {

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + core::escape_html(value) + "\"";
}
std::string attribute(const char* name, double value) {
  return attribute(name, core::number_text(value));
}

/// Returns the number of each row's track: rows that links join have the same.
std::vector<std::size_t> tracks_of(const StrokeTree& tree) {
  std::vector<std::size_t> parent(tree.rows.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& link : tree.links) parent[root(link.to)] = root(link.from);
  std::map<std::size_t, std::size_t> numbers;
  std::vector<std::size_t> tracks;
  for (std::size_t i = 0; i < parent.size(); ++i)
    tracks.push_back(numbers.emplace(root(i), numbers.size()).first->second);
  return tracks;
}

void write_spots(std::ostream& out, const StrokeTree& tree, const Units& units) {
  const double um = units.um.value_or(1);
  std::map<std::uint32_t, std::vector<std::size_t>> frames;
  for (std::size_t i = 0; i < tree.rows.size(); ++i) frames[tree.rows[i].frame].push_back(i);
  out << "    <AllSpots" << attribute("nspots", static_cast<double>(tree.rows.size())) << ">\n";
  for (const auto& [frame, spots] : frames) {
    out << "      <SpotsInFrame" << attribute("frame", frame) << ">\n";
    for (const auto i : spots) {
      const auto& row = tree.rows[i];
      const Point place = units.place(row.middle);
      const double radius = std::max(0.5, row.length / 2) * um;
      out << "        <Spot" << attribute("ID", static_cast<double>(i))
          << attribute("name", "stroke " + std::to_string(row.stroke)) << attribute("VISIBILITY", 1)
          << attribute("QUALITY", 1) << attribute("POSITION_X", place.x * um)
          << attribute("POSITION_Y", place.y * um) << attribute("POSITION_Z", 0)
          << attribute("POSITION_T", units.time(static_cast<int>(row.frame))) << attribute("FRAME", row.frame)
          << attribute("RADIUS", radius) << attribute("STROKE", row.stroke)
          << attribute("LENGTH", row.length * um) << "/>\n";
    }
    out << "      </SpotsInFrame>\n";
  }
  out << "    </AllSpots>\n";
}

/// Returns −ln p: costs of independent links add up, and the surest link is the cheapest. At most that of the
/// smallest normal number, since readers refuse infinity.
double link_cost(double probability) {
  return std::abs(std::log(std::max(std::numeric_limits<double>::min(), probability)));
}

void write_tracks(std::ostream& out, const StrokeTree& tree) {
  const auto tracks = tracks_of(tree);
  std::map<std::size_t, std::vector<const StrokeTree::Link*>> links;
  for (const auto& link : tree.links) links[tracks[link.from]].push_back(&link);
  out << "    <AllTracks>\n";
  for (const auto& [track, list] : links) {
    out << "      <Track" << attribute("name", "Track_" + std::to_string(track))
        << attribute("TRACK_ID", static_cast<double>(track)) << ">\n";
    for (const auto* link : list)
      out << "        <Edge" << attribute("SPOT_SOURCE_ID", static_cast<double>(link->from))
          << attribute("SPOT_TARGET_ID", static_cast<double>(link->to))
          << attribute("LINK_COST", link_cost(link->probability)) << "/>\n";
    out << "      </Track>\n";
  }
  out << "    </AllTracks>\n    <FilteredTracks>\n";
  for (const auto& [track, list] : links)
    out << "      <TrackID" << attribute("TRACK_ID", static_cast<double>(track)) << "/>\n";
  out << "    </FilteredTracks>\n";
}

}  // namespace

void write_trackmate(std::ostream& out, const StrokeTree& tree, const TrackedClip& clip) {
  const double um = clip.units.um.value_or(1), seconds = clip.units.seconds.value_or(1);
  const auto feature = [&](const char* name, const char* about, const char* dimension, bool whole) {
    return "        <Feature" + attribute("feature", std::string(name)) +
           attribute("name", std::string(about)) + attribute("shortname", std::string(about)) +
           attribute("dimension", std::string(dimension)) +
           attribute("isint", std::string(whole ? "true" : "false")) + "/>\n";
  };
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TrackMate version=\"7.11.1\">\n  <Model"
      << attribute("spatialunits", clip.units.um ? "µm" : "pixel")
      << attribute("timeunits", clip.units.seconds ? "sec" : "frame") << ">\n    <FeatureDeclarations>\n"
      << "      <SpotFeatures>\n"
      << feature("QUALITY", "Quality", "QUALITY", false) << feature("POSITION_X", "X", "POSITION", false)
      << feature("POSITION_Y", "Y", "POSITION", false) << feature("POSITION_Z", "Z", "POSITION", false)
      << feature("POSITION_T", "T", "TIME", false) << feature("FRAME", "Frame", "NONE", true)
      << feature("RADIUS", "Radius", "LENGTH", false) << feature("VISIBILITY", "Visibility", "NONE", true)
      << feature("STROKE", "Stroke", "NONE", true) << feature("LENGTH", "Length", "LENGTH", false)
      << "      </SpotFeatures>\n      <EdgeFeatures>\n"
      << feature("SPOT_SOURCE_ID", "Source spot ID", "NONE", true)
      << feature("SPOT_TARGET_ID", "Target spot ID", "NONE", true)
      << feature("LINK_COST", "Edge cost", "COST", false) << "      </EdgeFeatures>\n      <TrackFeatures>\n"
      << feature("TRACK_ID", "Track ID", "NONE", true)
      << "      </TrackFeatures>\n    </FeatureDeclarations>\n";
  write_spots(out, tree, clip.units);
  write_tracks(out, tree);
  out << "  </Model>\n  <Settings>\n    <ImageData" << attribute("filename", clip.name)
      << attribute("folder", std::string()) << attribute("width", clip.width)
      << attribute("height", clip.height) << attribute("nslices", 1) << attribute("nframes", clip.frames)
      << attribute("pixelwidth", um) << attribute("pixelheight", um) << attribute("voxeldepth", 1)
      << attribute("timeinterval", seconds) << "/>\n  </Settings>\n</TrackMate>\n";
}

void write_graphml(std::ostream& out, const StrokeTree& tree, const TrackedClip& clip) {
  struct Span {
    std::uint32_t first = 0, last = 0;
    double length = 0;
    int rows = 0;
  };
  std::map<std::uint32_t, Span> strokes;
  for (const auto& row : tree.rows) {
    auto& span = strokes.emplace(row.stroke, Span{row.frame, row.frame, 0, 0}).first->second;
    span.last = row.frame, span.length += row.length, ++span.rows;
  }
  const auto key = [&](const char* id, const char* of, const char* type) {
    out << "  <key" << attribute("id", std::string(id)) << attribute("for", std::string(of))
        << attribute("attr.name", std::string(id)) << attribute("attr.type", std::string(type)) << "/>\n";
  };
  const auto data = [&](const char* name, const std::string& value) {
    out << "<data" << attribute("key", std::string(name)) << ">" << core::escape_html(value) << "</data>";
  };
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml "
         "xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n";
  key("first", "node", "int"), key("last", "node", "int"), key("length", "node", "double");
  key("type", "edge", "string"), key("probability", "edge", "double"), key("frame", "edge", "int");
  out << "  <graph" << attribute("id", clip.name) << attribute("edgedefault", std::string("directed"))
      << ">\n";
  for (const auto& [stroke, span] : strokes) {
    out << "    <node" << attribute("id", "s" + std::to_string(stroke)) << ">";
    data("first", std::to_string(span.first)), data("last", std::to_string(span.last));
    data("length", core::number_text(core::round_to(span.length / span.rows, 3)));
    out << "</node>\n";
  }
  for (const auto& link : tree.links) {
    if (link.event.empty()) continue;
    out << "    <edge" << attribute("source", "s" + std::to_string(tree.rows[link.from].stroke))
        << attribute("target", "s" + std::to_string(tree.rows[link.to].stroke)) << ">";
    data("type", link.event), data("probability", core::number_text(link.probability));
    data("frame", std::to_string(tree.rows[link.to].frame));
    out << "</edge>\n";
  }
  out << "  </graph>\n</graphml>\n";
}

}  // namespace emberfold::graph
