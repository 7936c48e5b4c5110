// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

// The files of apps/motion_page/, embedded into the program by the build (cmake/embed_files.cmake).
namespace emberfold::apps {
extern const std::string_view kMotionPageTemplate, kMotionPageStyle, kMotionPageScript;

/// Returns the simulator compiled to WebAssembly; empty where its compiler was missing in the build
/// (cmake/wasm.cmake).
std::span<const unsigned char> motion_page_program();
}  // namespace emberfold::apps
