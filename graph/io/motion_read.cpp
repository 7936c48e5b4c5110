// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <istream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/frame_line.hpp"
#include "graph/io/motion_io.hpp"

namespace emberfold::graph {

namespace {

using nlohmann::json;

// Bytes; they bound the memory of reading a damaged file.
constexpr std::size_t kLongestHeader = std::size_t{1} << 16, kLongestLine = std::size_t{1} << 29;

struct Header {
  bool motion = false;
  int width = 0, height = 0;
  double fps = 0;
  std::uint64_t frames = 0;
};

std::uint64_t read_whole_number(const json& object, const char* key, std::uint64_t low, std::uint64_t high) {
  const auto found = object.find(key);
  if (found == object.end()) throw core::IoError("\"" + std::string(key) + "\" is missing");
  const bool good = found->is_number_unsigned() && *found >= low && *found <= high;
  if (!good) {
    throw core::IoError("\"" + std::string(key) + "\" must be a whole number from " + std::to_string(low) +
                        " to " + std::to_string(high));
  }
  return found->get<std::uint64_t>();
}

Header parse_header(std::string_view text, bool needs_links) {
  const json object = core::parse_json(text);
  if (!object.is_object()) throw core::IoError("is no header: must be a JSON object");
  const auto format = object.find("format");
  if (format == object.end() || !format->is_string())
    throw core::IoError("is no header: names no \"format\"");
  const auto& named = format->get_ref<const std::string&>();
  Header header;
  header.motion = named == "emberfold.motion";
  if (!header.motion && named != "emberfold.sketch") {
    throw core::IoError("the format is " + core::quoted(named) + ", expected \"emberfold.motion\"" +
                        (needs_links ? "" : " or \"emberfold.sketch\""));
  }
  const auto version = read_whole_number(object, "version", 1, ~std::uint64_t{0});
  const std::uint64_t newest = header.motion ? 2 : 1;
  if (version > newest) {
    throw core::IoError("format version " + std::to_string(version) + " is newer than this program's, " +
                        std::to_string(newest));
  }
  if (needs_links && !header.motion) {
    throw core::IoError(
        "the format is \"emberfold.sketch\", which has no links, expected \"emberfold.motion\"");
  }
  header.width = static_cast<int>(read_whole_number(object, "width", 1, 65536));
  header.height = static_cast<int>(read_whole_number(object, "height", 1, 65536));
  header.frames = read_whole_number(object, "frames", 0, 2147483647);
  const auto fps = object.find("fps");
  if (fps == object.end()) throw core::IoError("\"fps\" is missing");
  if (!fps->is_number() || !(fps->get<double>() > 0 && fps->get<double>() <= 1e6)) {
    throw core::IoError("\"fps\" must be a number above 0, up to 1e6");
  }
  header.fps = fps->get<double>();
  return header;
}

/// Reads the lines of a stream and counts them for messages.
class LineReader {
 public:
  explicit LineReader(std::istream& in) : in_(in) {}

  std::optional<std::string> next(std::size_t limit) {
    ++number_;
    auto line = core::read_line(in_, limit);
    if (!line) return std::nullopt;
    ended_ = line->ended;
    return std::move(line->text);
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Returns whether the last line had its line break; without one the file may be cut off.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  std::istream& in_;
  std::size_t number_ = 0;
  bool ended_ = true;
};

/// The frames read so far, and the highest vertex id in them.
struct PartialMotion {
  MotionGraph motion;
  std::optional<VertexId> last;
};

/// Adds a frame's links, sorted and checked, without those of skipped patches, which are kept for themselves.
void take_links(MotionGraph& motion, detail::FrameLine& line) {
  std::ranges::sort(line.skipped);
  if (!std::ranges::includes(line.links, line.skipped))
    throw core::IoError("\"skipped\" has a link that is not one of \"links\"");
  std::vector<Link> links;
  std::ranges::set_difference(line.links, line.skipped, std::back_inserter(links));
  const std::size_t frame = motion.links.size();
  motion.links.push_back(std::move(links));
  if (motion.skipped.empty() && line.skipped.empty()) return;
  motion.skipped.resize(frame);
  motion.skipped.push_back(std::move(line.skipped));
}

void add_frame(PartialMotion& partial, detail::FrameLine line, bool with_links) {
  auto& frames = partial.motion.sketch.frames;
  if (line.frame != frames.size()) {
    throw core::IoError("\"frame\" is " + std::to_string(line.frame) + ", expected " +
                        std::to_string(frames.size()));
  }
  if (with_links && !line.has_links) throw core::IoError("\"links\" is missing");
  try {
    AttributeGraph graph(std::move(line.vertices), std::move(line.edges));
    if (!graph.empty()) {
      const VertexId first = graph.vertices().front().id;
      if (partial.last && first <= *partial.last) {
        throw core::InputError("vertex " + std::to_string(first.value) +
                               " is not above the ids of the frames before, " +
                               std::to_string(partial.last->value));
      }
      partial.last = graph.vertices().back().id;
    }
    if (with_links) {
      if (without_anchors(graph).size() < graph.size())
        throw core::InputError("a vertex is an anchor, which is for sketches alone");
      std::sort(line.links.begin(), line.links.end());
      validate_links(frames.empty() ? AttributeGraph{} : frames.back(), graph, line.links);
      take_links(partial.motion, line);
    }
    frames.push_back(std::move(graph));
  } catch (const core::InputError& error) {
    throw core::IoError(error.what());
  }
}

MotionGraph read(std::istream& in, std::string_view name, bool with_links) {
  LineReader lines(in);
  try {
    const auto first = lines.next(kLongestHeader);
    if (!first) throw core::IoError("the file is empty");
    const Header header = parse_header(*first, with_links);
    PartialMotion partial;
    partial.motion.sketch.width = header.width;
    partial.motion.sketch.height = header.height;
    partial.motion.sketch.fps = header.fps;
    for (std::uint64_t t = 0; t < header.frames; ++t) {
      const auto text = lines.next(kLongestLine);
      if (!text) {
        throw core::IoError("the file ends after " + std::to_string(t) + " of " +
                            std::to_string(header.frames) + " frames");
      }
      add_frame(partial, detail::parse_frame_line(*text, header.width, header.height), with_links);
    }
    while (const auto text = lines.next(kLongestLine)) {
      if (text->find_first_not_of(" \t") == std::string::npos) continue;
      throw core::IoError("the file goes on after the " + std::to_string(header.frames) +
                          " frames that its header promises");
    }
    if (in.bad()) throw core::IoError("the stream failed");
    return std::move(partial.motion);
  } catch (const core::IoError& error) {
    const std::string cause = error.what();
    const bool cut = !lines.ended() && cause.starts_with("no valid JSON");
    throw core::IoError(std::string(name) + ": line " + std::to_string(lines.number()) + ": " + cause +
                        (cut ? ", the file is cut off there" : ""));
  }
}

}  // namespace

SketchSequence read_sketch(std::istream& in, std::string_view name) {
  return read(in, name, false).sketch;
}

MotionGraph read_motion(std::istream& in, std::string_view name) {
  return read(in, name, true);
}

}  // namespace emberfold::graph
