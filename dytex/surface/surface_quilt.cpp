// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/surface_quilt.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/text/size_text.hpp"
#include "dytex/quilting/quilt_checks.hpp"
#include "dytex/quilting/search.hpp"
#include "dytex/surface/surface_canvas.hpp"
#include "dytex/surface/texture_margin.hpp"

namespace emberfold::dytex {

namespace {

void check_surface_options(const SurfaceLayout& layout, const QuiltOptions& options) {
  options.validate();
  if (options.size != layout.size)
    throw core::InputError("QuiltOptions.size is " + core::size_text(options.size) +
                           "; allowed is the layout's size of " + core::size_text(layout.size));
  if (options.tileable) throw core::InputError("QuiltOptions.tileable is true; a surface allows false alone");
  if (options.seams != Seams::still)
    throw core::InputError("QuiltOptions.seams is moving; a surface allows still alone");
}

}  // namespace

SurfaceQuilt quilt_surface(const SurfaceLayout& layout, std::span<const QuiltSource> sources,
                           const QuiltOptions& options, const core::Context& context) {
  check_surface_options(layout, options);
  detail::check_sources(sources, options, {});
  context.report("basis", 0);
  const detail::BlockSearch search(sources, options, detail::joint_size(options.block), options.block,
                                   context);
  detail::SurfaceCanvas canvas(layout, sources, options);
  SurfaceQuilt result;
  result.components = search.components();
  while (const auto place = canvas.next()) {
    context.check();
    context.report("quilt", canvas.share());
    const auto query = canvas.query(*place);
    result.choices.push_back(search.choose(query));
    canvas.put(*place, result.choices.back().at);
  }
  result.map = canvas.take_map();
  result.blocks = canvas.take_blocks();
  detail::fill_margin(layout, result.map);
  return result;
}

}  // namespace emberfold::dytex
