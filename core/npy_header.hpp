// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "core/npy.hpp"

namespace emberfold::core {

/// Returns the header that write_npy writes, for an array whose numbers are written elsewhere: `array.data`
/// gives only their type.
std::string npy_header(const NpyView& array);

/// Writes the numbers alone, as write_npy does. Throws IoError if the stream fails.
void write_npy_values(std::ostream& out, const NpyView::Data& data);

}  // namespace emberfold::core
