// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace emberfold::apps {

/// Returns the known word with the least edit distance to `word`; empty where none is near.
/// Insertions, deletions, replacements and swaps of neighbours count (Damerau–Levenshtein). The limit is a
/// third of the word's length, and at least one.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace emberfold::apps
