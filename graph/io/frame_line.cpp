// SPDX-License-Identifier: Apache-2.0
#include "graph/io/frame_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/patch_range.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr std::array<std::string_view, 16> kVertexKeys = {
    "id",       "subgraph", "type",   "x",     "y",    "theta", "width",    "blur",
    "contrast", "left",     "middle", "right", "cost", "gain",  "evidence", "curve"};
enum VertexKey : unsigned {
  kId,
  kSubgraph,
  kType,
  kX,
  kY,
  kTheta,
  kWidth,
  kBlur,
  kContrast,
  kLeft,
  kMiddle,
  kRight,
  kCost,
  kGain,
  kEvidence,
  kCurve
};
constexpr unsigned kOptionalKeys = 1U << kCost | 1U << kGain | 1U << kEvidence | 1U << kCurve;
constexpr unsigned kAnchorKeys = 1U << kId | 1U << kType | 1U << kX | 1U << kY | 1U << kMiddle;
constexpr std::array<std::string_view, 5> kFrameKeys = {"frame", "vertices", "edges", "links", "skipped"};
enum FrameKey : unsigned { kFrame, kVertices, kEdges, kLinks, kSkipped };
constexpr unsigned kUnknown = ~0U;

template <std::size_t N>
unsigned find(const std::array<std::string_view, N>& keys, std::string_view key) {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? kUnknown : static_cast<unsigned>(found - keys.begin());
}

[[noreturn]] void fail(const std::string& cause) {
  throw core::IoError(cause);
}

std::string in_quotes(std::string_view text) {
  return "\"" + std::string(text) + "\"";
}

/// Receives the parser's events and builds the line.
class Handler {
 public:
  FrameLine line;

  Handler(int width, int height) : width_(width), height_(height) {}

  bool null() { return other("null"); }
  bool boolean(bool) { return other("true or false"); }
  bool binary(nlohmann::json::binary_t&) { return other("binary data"); }
  bool number_integer(nlohmann::json::number_integer_t value) {
    return number(static_cast<double>(value), false, 0);
  }
  bool number_unsigned(nlohmann::json::number_unsigned_t value) {
    return number(static_cast<double>(value), value <= 0xffffffffU, static_cast<std::uint32_t>(value));
  }
  bool number_float(nlohmann::json::number_float_t value, const std::string&) {
    return number(value, false, 0);
  }

  bool string(std::string& value) {
    if (place_ == Place::skip) return true;
    if (place_ != Place::vertex || key_ != kType) return other("a text");
    const auto type = patch_type(value);
    if (!type) fail(vertex_name() + "the type " + core::quoted(value) + " is not known");
    line.vertices.back().patch.type = *type;
    return true;
  }

  bool start_object(std::size_t) {
    switch (place_) {
      case Place::nothing:
        place_ = Place::frame;
        return true;
      case Place::vertices:
        line.vertices.emplace_back();
        seen_vertex_ = 0;
        key_ = kUnknown;
        place_ = Place::vertex;
        return true;
      default:
        return open("an object");
    }
  }

  bool key(std::string& value) {
    if (place_ == Place::skip) return true;
    const bool top = place_ == Place::frame;
    key_ = top ? find(kFrameKeys, value) : find(kVertexKeys, value);
    if (key_ == kUnknown) return true;
    unsigned& seen = top ? seen_frame_ : seen_vertex_;
    if ((seen >> key_) & 1U) fail((top ? "" : vertex_name()) + in_quotes(value) + " is there twice");
    seen |= 1U << key_;
    return true;
  }

  bool end_object() {
    if (place_ == Place::skip) return close();
    if (place_ == Place::frame) {
      require_all(kFrameKeys, seen_frame_ | 1U << kLinks | 1U << kSkipped, "");
      line.has_links = ((seen_frame_ >> kLinks) & 1U) != 0;
      place_ = Place::done;
      return true;
    }
    Vertex& vertex = line.vertices.back();
    require_all(kVertexKeys, seen_vertex_ | (is_anchor(vertex.patch) ? ~kAnchorKeys : kOptionalKeys),
                vertex_name());
    if (const auto wrong = detail::describe_range_error(vertex.patch, width_, height_); !wrong.empty())
      fail(vertex_name() + wrong);
    if (is_anchor(vertex.patch))
      vertex = {vertex.id, {}, make_anchor(vertex.patch.position, vertex.patch.middle)};
    place_ = Place::vertices;
    return true;
  }

  bool start_array(std::size_t) {
    if (place_ == Place::frame && key_ != kUnknown && key_ != kFrame) {
      place_ = key_ == kVertices ? Place::vertices : Place::pairs;
      return true;
    }
    if (place_ == Place::pairs) {
      place_ = Place::pair;
      count_ = 0;
      return true;
    }
    if (place_ == Place::vertex && key_ != kUnknown && key_ >= kLeft && key_ <= kRight) {
      place_ = Place::level;
      count_ = 0;
      return true;
    }
    return open("a list");
  }

  bool end_array() {
    switch (place_) {
      case Place::skip:
        return close();
      case Place::level:
        if (count_ != 3) fail(vertex_name() + in_quotes(kVertexKeys[key_]) + " must be one number or three");
        place_ = Place::vertex;
        return true;
      case Place::pair:
        if (count_ != 2) fail("every one of " + in_quotes(kFrameKeys[key_]) + " must be a pair of ids");
        if (key_ == kEdges) line.edges.push_back({{pair_[0]}, {pair_[1]}});
        if (key_ == kLinks) line.links.push_back({{pair_[0]}, {pair_[1]}});
        if (key_ == kSkipped) line.skipped.push_back({{pair_[0]}, {pair_[1]}});
        place_ = Place::pairs;
        return true;
      default:
        place_ = Place::frame;
        return true;
    }
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    if (error.id >= 400) fail("no valid JSON: a number out of range");
    fail("no valid JSON at column " + std::to_string(position));
  }

 private:
  enum class Place { nothing, frame, vertices, vertex, level, pairs, pair, skip, done };

  [[nodiscard]] std::string vertex_name() const {
    return "vertex " + std::to_string(line.vertices.size() - 1) + " of the list: ";
  }

  template <std::size_t N>
  static void require_all(const std::array<std::string_view, N>& keys, unsigned seen,
                          const std::string& where) {
    for (unsigned k = 0; k < N; ++k) {
      if (((seen >> k) & 1U) == 0) fail(where + in_quotes(keys[k]) + " is missing");
    }
  }

  /// Handles an object or list that opens where the format has none.
  bool open(const char* what) {
    if (place_ == Place::skip) {
      ++depth_;
      return true;
    }
    if ((place_ == Place::frame || place_ == Place::vertex) && key_ == kUnknown) {
      outside_ = place_;
      place_ = Place::skip;
      depth_ = 1;
      return true;
    }
    return other(what);
  }

  bool close() {
    if (--depth_ == 0) place_ = outside_;
    return true;
  }

  /// Handles a value that is allowed under an unknown key only.
  bool other(const char* what) {
    if (place_ == Place::skip) return true;
    if ((place_ == Place::frame || place_ == Place::vertex) && key_ == kUnknown) return true;
    switch (place_) {
      case Place::nothing:
        fail("must be an object, is " + std::string(what));
      case Place::frame:
        fail(in_quotes(kFrameKeys[key_]) + " must be " + (key_ == kFrame ? "a whole number" : "a list") +
             ", is " + what);
      case Place::vertices:
        fail("\"vertices\" must hold objects, holds " + std::string(what));
      case Place::vertex:
        fail(vertex_name() + in_quotes(kVertexKeys[key_]) + " must be " +
             (key_ == kType ? "a text" : "a number") + ", is " + what);
      case Place::level:
        fail(vertex_name() + in_quotes(kVertexKeys[key_]) + " must hold numbers, holds " + what);
      default:
        fail("every one of " + in_quotes(kFrameKeys[key_]) + " must be a pair of ids, one is or holds " +
             what);
    }
  }

  bool number(double value, bool is_id, std::uint32_t id) {
    switch (place_) {
      case Place::vertex:
        return key_ == kUnknown || vertex_number(value, is_id, id);
      case Place::level:
        if (count_ < 3) level()[count_] = to_float(value);
        count_ = std::min<std::size_t>(count_ + 1, 4);
        return true;
      case Place::pair:
        if (!is_id) fail(in_quotes(kFrameKeys[key_]) + " must hold whole numbers from 0 to 4294967295");
        if (count_ < 2) pair_[count_] = id;
        count_ = std::min<std::size_t>(count_ + 1, 3);
        return true;
      case Place::frame:
        if (key_ != kFrame) return other("a number");
        if (!is_id) fail("\"frame\" must be a whole number from 0");
        line.frame = id;
        return true;
      default:
        return other("a number");
    }
  }

  bool vertex_number(double value, bool is_id, std::uint32_t id) {
    Vertex& vertex = line.vertices.back();
    if ((key_ <= kSubgraph || key_ == kCurve) && !is_id) {
      fail(vertex_name() + in_quotes(kVertexKeys[key_]) + " must be a whole number from 0 to 4294967295");
    }
    switch (key_) {
      case kId:
        vertex.id = {id};
        return true;
      case kSubgraph:
        vertex.subgraph = {id};
        return true;
      case kCurve:
        vertex.curve = {id};
        return true;
      case kType:
        return other("a number");
      case kX:
        vertex.patch.position.x = value;
        return true;
      case kY:
        vertex.patch.position.y = value;
        return true;
      case kTheta:
        vertex.patch.theta = value;
        return true;
      case kWidth:
        vertex.patch.width = value;
        return true;
      case kBlur:
        vertex.patch.blur = value;
        return true;
      case kContrast:
        vertex.patch.contrast = value;
        return true;
      case kCost:
        vertex.patch.cost = value;
        return true;
      case kGain:
        vertex.patch.gain = value;
        return true;
      case kEvidence:
        vertex.patch.evidence = value;
        return true;
      default:
        level().fill(to_float(value));
        return true;
    }
  }

  Level& level() {
    Patch& patch = line.vertices.back().patch;
    switch (key_) {
      case kLeft:
        return patch.left;
      case kMiddle:
        return patch.middle;
      default:
        return patch.right;
    }
  }

  /// Converts to float; numbers beyond its range become infinite and are refused with the vertex.
  static float to_float(double value) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
      return std::numeric_limits<float>::infinity();
    }
    return static_cast<float>(value);
  }

  int width_, height_;
  Place place_ = Place::nothing, outside_ = Place::nothing;
  std::size_t depth_ = 0, count_ = 0;
  unsigned key_ = kUnknown, seen_frame_ = 0, seen_vertex_ = 0;
  std::array<std::uint32_t, 2> pair_{};
};

}  // namespace

FrameLine parse_frame_line(std::string_view text, int width, int height) {
  Handler handler(width, height);
  nlohmann::json::sax_parse(text.begin(), text.end(), &handler);
  return std::move(handler.line);
}

}  // namespace emberfold::graph::detail
