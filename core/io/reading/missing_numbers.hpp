// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace emberfold::io {

/// Describes which numbers are missing in the names of a sequence of images (img_07.png, img_09.png), in
/// natural order. The usual step from one to the next may be other than 1. Empty where none is missing, or
/// where the names differ in more than their last number.
std::string missing_numbers(const std::vector<std::filesystem::path>& files);

}  // namespace emberfold::io
