// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace emberfold::io {

/// Says in words which numbers are missing in the names of a sequence of images (img_07.png, img_09.png), in
/// natural order. The usual step from one to the next may be other than 1. Empty where none is, or where the
/// names do not differ in their last number alone.
std::string missing_numbers(const std::vector<std::filesystem::path>& files);

}  // namespace emberfold::io
