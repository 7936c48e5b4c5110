// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/cli/command.hpp"
#include "core/io/clip_reader.hpp"

namespace emberfold::apps {

/// Opens a clip as io::open_video does, or builtin:fire|cloth|river|rust, made from options.seed and kept in
/// memory. core::InputError for another built-in name.
std::unique_ptr<core::FrameSource> open_clip(const std::string& name, const io::ReadOptions& options,
                                             const core::Warn& warn);
/// Opens a clip for a command; warnings go to its session.
std::unique_ptr<core::FrameSource> open_clip(const std::string& name, const io::ReadOptions& options,
                                             Session& session);

/// Opens a clip for a command that examines all pixels: those outside --mask stand still (core::HeldOutside).
std::unique_ptr<core::FrameSource> open_held_clip(const std::string& name, const io::ReadOptions& options,
                                                  const core::Warn& warn);
std::unique_ptr<core::FrameSource> open_held_clip(const std::string& name, const io::ReadOptions& options,
                                                  Session& session);

}  // namespace emberfold::apps
