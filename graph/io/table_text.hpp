// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::graph::detail {

/// A line of a table whose values are separated by commas.
class TableLine {
 public:
  explicit TableLine(std::string& text) : text_(text) {}
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
  void end() { text_ += '\n'; }

 private:
  void separate() {
    if (!first_) text_ += ',';
    first_ = false;
  }

  std::string& text_;
  bool first_ = true;
};

/// Writes a whole table. Throws core::IoError if the stream fails.
inline void write_table(std::ostream& out, const std::string& text) {
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("a table could not be written: the stream failed");
}

}  // namespace emberfold::graph::detail
