// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/model_archive.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// Makes the view of archive_view() without C, whose rows are written elsewhere; of `texture.C` only the
/// number of columns counts. The texture is not validated. It must outlive the view.
core::ModelView archive_view_without_C(const LinearDynamicTexture& texture);
core::ModelView archive_view_without_C(LinearDynamicTexture&&) = delete;

}  // namespace emberfold::dytex
