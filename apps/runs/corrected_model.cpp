// SPDX-License-Identifier: Apache-2.0
#include "apps/runs/corrected_model.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/cli/command.hpp"
#include "core/error.hpp"
#include "core/fingerprint.hpp"
#include "core/io/column_folder.hpp"
#include "pipeline/rate_correction.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

std::optional<fs::path> cache_folder() {
  for (const auto& [name, below] : {std::pair("XDG_CACHE_HOME", ""), std::pair("HOME", ".cache")}) {
    const char* const root = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets it here
    if (root != nullptr && fs::path(root).is_absolute())
      return fs::path(root) / below / "emberfold" / "corrected";
  }
  return std::nullopt;
}

/// Returns all numbers that a correction changes.
std::vector<double*> corrected_numbers(mcmc::OperatorRates& rates) {
  std::vector<double*> numbers;
  for (auto* list : {&rates.birth_by_size, &rates.death_by_size})
    for (double& value : *list) numbers.push_back(&value);
  for (double* value : {&rates.split, &rates.merge, &rates.connect, &rates.disconnect})
    numbers.push_back(value);
  for (auto& value : rates.birth.values) numbers.push_back(&value);
  return numbers;
}

std::string key_of(const pipeline::ClipModel& model) {
  auto archive = mcmc::to_archive(model.motion);
  add_rate_correction(archive, *model.correction);
  core::Fingerprint sum;
  sum.add(kVersion).add(archive.text);
  for (const auto& [name, array] : archive.arrays) {
    sum.add(name);
    std::visit(
        [&](const auto& values) {
          sum.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])});
        },
        array.data);
  }
  return sum.text();
}

/// Sets the stored rates; returns false where there are none, or they belong to another model.
bool read_rates(const fs::path& folder, const std::string& key, pipeline::ClipModel& model) {
  const auto columns = io::read_columns(folder, key);
  if (!columns || !columns->arrays.contains("rates")) return false;
  const auto* const kept = std::get_if<std::vector<double>>(&columns->arrays.at("rates").data);
  const auto numbers = corrected_numbers(model.motion.rates);
  if (kept == nullptr || kept->size() != numbers.size()) return false;
  for (std::size_t i = 0; i < numbers.size(); ++i) *numbers[i] = (*kept)[i];
  model.correction.reset();
  return true;
}

}  // namespace

void correct_rates_once(pipeline::ClipModel& model, const core::Context& context) {
  if (!model.correction) return;
  const auto cache = cache_folder();
  const auto key = key_of(model);
  if (cache && read_rates(*cache / key, key, model)) return;
  correct_rates(model, context);
  if (!cache) return;
  std::vector<double> rates;
  for (const double* value : corrected_numbers(model.motion.rates)) rates.push_back(*value);
  try {
    io::write_columns(*cache / key, {key, {}, {{"rates", {{rates.size()}, false, rates}}}});
  } catch (const core::IoError&) {  // then it is computed again the next time
  }
}

}  // namespace emberfold::apps
