// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace emberfold::io {

/// Returns the first image of a folder or pattern; of other names the name itself. Throws as list_images.
std::filesystem::path first_file(const std::string& name);

/// Throws core::InputError that names the patterns where images are several numbered series (a_1.png …,
/// b_1.png …), which would become one clip. Names are compared without their numbers; a few stray images are
/// no series.
void refuse_several_series(const std::vector<std::filesystem::path>& files);

/// Returns a warning where series whose names differ in an earlier number (img_c0_001 …, img_c1_001 …) have
/// the same last numbers: they may be channels, or hours of one clip. Empty otherwise.
std::string repeated_numbers(const std::vector<std::filesystem::path>& files);

/// Throws core::InputError where one of several files is a TIFF stack: a clip itself, not a frame.
void refuse_stacks(const std::vector<std::filesystem::path>& files);

/// Returns the number of pages of a TIFF that may be frames: pictures of the same size as the first. 1 for
/// files of other kinds, and for a TIFF that cannot be read.
int pages_alike(const std::filesystem::path& path);

}  // namespace emberfold::io
