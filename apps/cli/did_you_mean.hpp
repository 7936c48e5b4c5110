// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace emberfold::apps {

/// The known word that `word` is most likely a slip of: fewest insertions, deletions, replacements and swaps
/// of neighbours, at most a third of its length (and at least one). Empty where none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace emberfold::apps
