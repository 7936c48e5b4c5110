// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::core {

/// Returns the shortest decimal text that reads back to the same number, or "not finite".
std::string number_text(double value);

}  // namespace emberfold::core
