// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model_archive.hpp"
#include "dytex/editing/edit.hpp"

// How edits of a linear dynamic texture are written down: as the words of `emberfold dytex edit`.
namespace emberfold::apps {

/// "--speed 2 --channel r --flow 0.5 --no-contrast --coarse 1.5": what makes these edits of a model, in their
/// order. Numbers read back to the same bits. Scales of 1 have no words.
std::string edit_words(std::span<const dytex::Edit> edits);

/// b, g, r or blue, green, red: 0 … 2; all: none. core::InputError, telling what is allowed, for another
/// text.
std::optional<int> parse_channel(const std::string& text);

/// Numbers with commas or white space between them, in the text itself or, if it is none of numbers, in the
/// file of that name. core::IoError where it is neither.
std::vector<double> parse_numbers(const std::string& text);

/// What a model went through since it was learned: the words of each `emberfold dytex edit`, the first one
/// first; kept as "edits" in its model.json. core::IoError where that is no list of texts.
std::vector<std::string> edit_history(const std::string& model_text);
/// The model.json's text with that list.
std::string with_edit_history(const std::string& model_text, const std::vector<std::string>& history);

}  // namespace emberfold::apps
