// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// A page takes at most so many values of components (m n), other numbers, and numbers of a state.
constexpr long long kPageValues = 48'000'000, kPageNumbers = 8'000'000, kPageOrder = 400;

struct TexturePageInput {
  const dytex::LinearDynamicTexture* texture = nullptr;
  std::string model;               ///< its folder, as the user gave it
  std::vector<std::string> edits;  ///< what it went through, as apps/textures/texture_edits.hpp tells
  std::string version;
};

struct TexturePage {
  std::string html;
  double error = 0;          ///< levels, RMS, of frames drawn from the page's components
  double largest_error = 0;  ///< levels, of some training frames' values
};

/// A page that runs the texture live in a browser and needs nothing else: mean and components as images of
/// whole numbers whose steps are as fine as their amplitude asks for (0.2 levels RMS of a frame), all else as
/// doubles. InputError where the texture is not valid or too large; NumericalError as of dytex::edit.
TexturePage make_texture_page(const TexturePageInput& input);

}  // namespace emberfold::apps
