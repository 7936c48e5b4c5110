// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace emberfold::core {

/// Escapes & < > " ' for HTML and XML.
std::string escape_html(std::string_view text);

}  // namespace emberfold::core
