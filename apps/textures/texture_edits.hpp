// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/model_archive.hpp"
#include "dytex/editing/edit.hpp"

// Writes edits of a linear dynamic texture as options of `emberfold dytex edit`.
namespace emberfold::apps {

/// Writes edits in their order, as "--speed 2 --flow 0.5 --no-contrast --coarse 1.5".
/// Parsing gives the same bits. Scales of 1 are omitted.
std::string edit_words(std::span<const dytex::Edit> edits);

/// Parses numbers separated by commas or white space, from the text itself, otherwise from the file of that
/// name. Throws core::IoError where neither works.
std::vector<double> parse_numbers(const std::string& text);

/// Returns the edits of a model since it was learned, oldest first, as options of `emberfold dytex edit`.
/// Reads "edits" in its model.json. Throws core::IoError where that is no list of texts.
std::vector<std::string> edit_history(const std::string& model_text);
/// Returns the text of model.json with that list of edits.
std::string with_edit_history(const std::string& model_text, const std::vector<std::string>& history);

}  // namespace emberfold::apps
