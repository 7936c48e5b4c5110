// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Applies the options to a decoded clip, in the order given at ReadOptions. `name`: for messages. Throws as
/// open_video does.
std::unique_ptr<core::FrameSource> transform_clip(std::string name, std::unique_ptr<FrameDecoder> decoder,
                                                  const ReadOptions& options, const core::Warn& warn);

}  // namespace emberfold::io
