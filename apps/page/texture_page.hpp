// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// Limits of a page that browsers can load: values of components (m n), other numbers, order n.
constexpr long long kPageValues = 48'000'000, kPageNumbers = 8'000'000, kPageOrder = 400;

/// A texture and its labels on the page.
struct TexturePageInput {
  const dytex::LinearDynamicTexture* texture = nullptr;
  std::string model;               ///< its folder, as given by the user
  std::vector<std::string> edits;  ///< its earlier edits, as in apps/textures/texture_edits.hpp
  std::string version;
};

/// The page and its rounding errors.
struct TexturePage {
  std::string html;
  double error = 0;          ///< levels, RMS, of frames drawn from the page's components
  double largest_error = 0;  ///< levels, over the values of some training frames
};

/// Makes a self-contained page that runs the texture live in a browser. Mean and components are images of
/// whole numbers whose steps follow from their amplitudes (0.2 levels RMS of a frame), everything else is in
/// doubles. Throws InputError where the texture is not valid or too large; NumericalError as
/// dytex::edit.
TexturePage make_texture_page(const TexturePageInput& input);

}  // namespace emberfold::apps
