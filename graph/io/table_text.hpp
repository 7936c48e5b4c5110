// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/units.hpp"

namespace emberfold::graph::detail {

/// Ends the head of a table: the columns of times and of lengths where they are known, and counted_from.
inline void end_head(std::string& text, const Units& units, std::string_view times, std::string_view lengths,
                     std::string_view speeds = {}) {
  if (units.seconds) text += times;
  if (units.um) text += lengths;
  if (units.seconds && units.um) text += speeds;
  if (!units.origin.counted_from.empty()) text += ",counted_from";
  text += '\n';
}

/// A line of a table whose values are separated by commas.
class TableLine {
 public:
  TableLine(std::string& text, const Units& units) : text_(text), units_(units) {}
  template <class Number>
  void add(Number value) {
    separate();
    core::append_number(text_, value);
  }
  /// Adds a name that needs no quotes.
  void add_name(std::string_view name) {
    separate();
    text_ += name;
  }
  /// Adds a position, px.
  void add_place(Point position) {
    const Point place = units_.place(position);
    add(place.x), add(place.y);
  }
  /// Adds the time of a frame, s, where it is known.
  void add_time(int frame) {
    if (units_.seconds) add(units_.time(frame));
  }
  /// Adds a position, µm, where it is known.
  void add_place_um(Point position) {
    if (!units_.um) return;
    const Point place = units_.place(position);
    add(place.x * *units_.um), add(place.y * *units_.um);
  }
  /// Adds a length in px as µm, where it is known.
  void add_length_um(double length) {
    if (units_.um) add(length * *units_.um);
  }
  void end() {
    if (const auto& from = units_.origin.counted_from; !from.empty()) add_name(from);
    text_ += '\n';
  }

 private:
  void separate() {
    if (!first_) text_ += ',';
    first_ = false;
  }

  std::string& text_;
  const Units& units_;
  bool first_ = true;
};

/// Writes a whole table. Throws core::IoError if the stream fails.
inline void write_table(std::ostream& out, const std::string& text) {
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("a table could not be written: the stream failed");
}

}  // namespace emberfold::graph::detail
