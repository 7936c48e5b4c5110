// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::python {

/// Returns the comment of a declaration in the installed headers, "sketch::ExtractOptions::spacing" for
/// instance, as the build has read it off them; empty where there is none. Lives as long as the process.
const char* doc(const std::string& name);

}  // namespace emberfold::python
