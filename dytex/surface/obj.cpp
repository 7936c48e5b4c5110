// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <numeric>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/text/format_number.hpp"
#include "core/text/json_reader.hpp"
#include "dytex/surface/polygon.hpp"
#include "dytex/surface/uv_mesh.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kLongestObjLine = std::size_t{1} << 16;  // bytes
constexpr std::size_t kMostOfAKind = std::size_t{1} << 24;     // points, places, triangles
constexpr std::size_t kMostCorners = 256;                      // of a face
constexpr double kFarthest = 1e12;                             // of a point from 0, each way

using Words = std::vector<std::string_view>;

Words words_of(std::string_view line) {
  Words words;
  constexpr std::string_view kSpace = " \t";
  for (std::size_t at = 0; (at = line.find_first_not_of(kSpace, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

double number_of(std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || stop != digits.data() + digits.size() || !(std::abs(value) <= kFarthest))
    throw core::IoError(core::quoted(word) + " is no number from -1e12 to 1e12");
  return value;
}

void check_count(const Words& words, std::size_t least, std::size_t most) {
  const std::size_t count = words.size() - 1;
  if (count < least || count > most)
    throw core::IoError(std::string(words[0]) + " has " + std::to_string(count) + " values; allowed are " +
                        std::to_string(least) + " to " + std::to_string(most));
}

void check_room(std::size_t count, const char* what) {
  if (count >= kMostOfAKind)
    throw core::IoError("there are more than " + std::to_string(kMostOfAKind) + " " + what);
}

// Returns the entry, from 0, that a face names: counted from 1, or, with a minus, back from the last so far.
std::int32_t index_of(std::string_view word, std::size_t count, const char* what) {
  long long value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const auto last = static_cast<long long>(count);
  const bool number = error == std::errc{} && stop == word.data() + word.size();
  if (!number || value == 0 || value > last || value < -last)
    throw core::IoError("f names " + std::string(what) + " " + core::quoted(word) +
                        (count == 0 ? "; there is none before it"
                                    : "; allowed is 1 to " + std::to_string(last) + ", or back from -1 to " +
                                          std::to_string(-last)));
  return static_cast<std::int32_t>(value > 0 ? value - 1 : last + value);
}

/// Reads an OBJ file line by line.
class ObjLines {
 public:
  void take(std::string_view line) {
    const Words words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) return;
    if (words[0] == "v")
      take_point(words);
    else if (words[0] == "vt")
      take_uv(words);
    else if (words[0] == "f")
      take_face(words);
    else if (std::ranges::find(kPassedOver, words[0]) == kPassedOver.end())
      throw core::IoError(
          core::quoted(words[0]) +
          " is not read; allowed are v, vt and f, and vn, o, g, s, usemtl, mtllib, p and l, which "
          "are passed over");
  }

  UvMesh mesh;

 private:
  static constexpr std::array<std::string_view, 8> kPassedOver{"vn",     "o",      "g", "s",
                                                               "usemtl", "mtllib", "p", "l"};

  void take_point(const Words& words) {
    check_count(words, 3, 7);  // a weight or a colour may follow
    check_room(mesh.points.size(), "points");
    mesh.points.emplace_back(number_of(words[1]), number_of(words[2]), number_of(words[3]));
  }

  void take_uv(const Words& words) {
    check_count(words, 2, 3);
    check_room(mesh.uvs.size(), "places in the texture");
    mesh.uvs.emplace_back(number_of(words[1]), number_of(words[2]));
  }

  UvCorner corner_of(std::string_view word) const {
    const std::size_t slash = word.find('/');
    const std::string_view rest = slash == std::string_view::npos ? "" : word.substr(slash + 1);
    const std::string_view uv = rest.substr(0, rest.find('/'));
    if (uv.empty())
      throw core::IoError("f has the corner " + core::quoted(word) +
                          "; allowed are corners with a place in the texture, as 1/1 or 1/1/1");
    const UvCorner corner{index_of(word.substr(0, slash), mesh.points.size(), "the point"),
                          index_of(uv, mesh.uvs.size(), "the place in the texture")};
    const auto& [u, v] = mesh.uvs[static_cast<std::size_t>(corner.uv)];
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1))
      throw core::IoError("f names the place " + core::number_text(u) + " " + core::number_text(v) +
                          " in the texture; allowed is 0 to 1, as nothing is repeated");
    return corner;
  }

  void take_face(const Words& words) {
    check_count(words, 3, kMostCorners);
    std::vector<UvCorner> corners;
    std::vector<cv::Point2d> places;
    for (const auto word : std::span(words).subspan(1)) {
      corners.push_back(corner_of(word));
      places.push_back(mesh.uvs[static_cast<std::size_t>(corners.back().uv)]);
    }
    for (const auto& [a, b, c] : detail::cut_polygon(places)) {
      check_room(mesh.triangles.size(), "triangles");
      mesh.triangles.push_back({corners[a], corners[b], corners[c]});
    }
  }
};

// Removes repeated values and returns for each value its new index.
template <class Value, class Key>
std::vector<std::int32_t> join_equal(std::vector<Value>& values, const Key& key) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    const auto left = key(values[a]), right = key(values[b]);
    return left != right ? left < right : a < b;
  });
  std::vector<std::size_t> first(values.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] =
        i > 0 && key(values[order[i]]) == key(values[order[i - 1]]) ? first[order[i - 1]] : order[i];
  std::vector<std::int32_t> now(values.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    now[i] = first[i] == i ? static_cast<std::int32_t>(kept) : now[first[i]];
    if (first[i] == i) values[kept++] = values[i];
  }
  values.resize(kept);
  return now;
}

void join_corners(UvMesh& mesh) {
  const auto points = join_equal(mesh.points, [](const cv::Point3d& p) { return std::tuple(p.x, p.y, p.z); });
  const auto uvs = join_equal(mesh.uvs, [](const cv::Point2d& p) { return std::pair(p.x, p.y); });
  for (auto& triangle : mesh.triangles)
    for (auto& corner : triangle)
      corner = {points[static_cast<std::size_t>(corner.point)], uvs[static_cast<std::size_t>(corner.uv)]};
}

// Returns the next line, joined with those that follow a backslash at its end.
std::optional<std::string> whole_line(std::istream& in, std::size_t& number) {
  std::optional<std::string> whole;
  for (;;) {
    auto line = core::read_line(in, kLongestObjLine);
    if (!line) return whole;
    ++number;
    whole = whole.value_or("") + line->text;
    if (whole->size() > kLongestObjLine)
      throw core::IoError("longer than " + std::to_string(kLongestObjLine >> 10) + " KiB");
    if (whole->empty() || whole->back() != '\\') return whole;
    whole->back() = ' ';
  }
}

}  // namespace

UvMesh read_obj(std::istream& in, std::string_view name) {
  ObjLines lines;
  std::size_t number = 0, begin = 1;
  try {
    while (const auto line = whole_line(in, number)) {
      lines.take(*line);
      begin = number + 1;
    }
  } catch (const core::IoError& error) {
    throw core::IoError(std::string(name) + ": line " + std::to_string(begin) + ": " + error.what());
  }
  if (in.bad()) throw core::IoError(std::string(name) + ": cannot be read to its end");
  if (lines.mesh.triangles.empty())
    throw core::IoError(std::string(name) + ": there is no face (f) in it, so that no surface is known");
  join_corners(lines.mesh);
  return std::move(lines.mesh);
}

void write_obj(std::ostream& out, const UvMesh& mesh) {
  std::string text;
  const auto put = [&](const char* word, std::initializer_list<double> numbers) {
    text += word;
    for (const double number : numbers) {
      text += ' ';
      core::append_number(text, number);
    }
    text += '\n';
  };
  for (const auto& p : mesh.points) put("v", {p.x, p.y, p.z});
  for (const auto& p : mesh.uvs) put("vt", {p.x, p.y});
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const auto& corner : triangle)
      text += " " + std::to_string(corner.point + 1) + "/" + std::to_string(corner.uv + 1);
    text += '\n';
  }
  out << text;
}

}  // namespace emberfold::dytex
