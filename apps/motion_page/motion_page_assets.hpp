// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

// The files of apps/motion_page/, put into the program when it is built (cmake/embed_files.cmake).
namespace emberfold::apps {
extern const std::string_view kMotionPageTemplate, kMotionPageStyle, kMotionPageScript;

/// Returns the simulator compiled to WebAssembly; nothing where the compiler for that was missing when the
/// program was built (cmake/wasm.cmake).
std::span<const unsigned char> motion_page_program();
}  // namespace emberfold::apps
