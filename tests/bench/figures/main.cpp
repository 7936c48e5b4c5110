// SPDX-License-Identifier: Apache-2.0
// Measures the primal sketch and prints one table; docs/benchmarks.md tells how to run it.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/freed_memory.hpp"
#include "tests/bench/figures/measures.hpp"
#include "tests/bench/figures/table.hpp"

using namespace emberfold::figures;

namespace {

struct Measure {
  const char* name;
  std::vector<Row> (*run)(const Inputs&);
};
constexpr Measure kMeasures[] = {
    {"profiles", profiles}, {"scenes", scenes},         {"reconstruction", reconstruction},
    {"noise", noise},       {"steadiness", steadiness}, {"symmetry", symmetry},
    {"speed", speed}};

struct Arguments {
  Inputs inputs;
  std::vector<std::string> only;
};

std::string from_environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::string names() {
  std::string text;
  for (const Measure& measure : kMeasures) text += (text.empty() ? "" : ", ") + std::string(measure.name);
  return text;
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments{{from_environment("EMBERFOLD_CLIPS"), from_environment("EMBERFOLD_SCENES"), {}}, {}};
  for (std::size_t i = 0; i < words.size(); i += 2) {
    const std::string& option = words[i];
    if (option != "--clips" && option != "--scenes" && option != "--dump" && option != "--only")
      throw std::runtime_error(
          "no option " + option +
          "; usage: sketch_figures [--clips DIR] [--scenes DIR] [--only NAME]... [--dump DIR]");
    if (i + 1 == words.size()) throw std::runtime_error(option + " needs a value");
    const std::string& value = words[i + 1];
    if (option == "--clips") arguments.inputs.clips = value;
    if (option == "--scenes") arguments.inputs.scenes = value;
    if (option == "--dump") {
      arguments.inputs.dump = value;
      std::filesystem::create_directories(value);
    }
    if (option != "--only") continue;
    if (std::ranges::none_of(kMeasures, [&](const Measure& m) { return value == m.name; }))
      throw std::runtime_error("--only " + value + ": the measures are " + names());
    arguments.only.push_back(value);
  }
  return arguments;
}

void run(const Arguments& arguments) {
  print_heading(std::cout);
  std::vector<Row> all;
  for (const Measure& measure : kMeasures) {
    if (!arguments.only.empty() && std::ranges::find(arguments.only, measure.name) == arguments.only.end())
      continue;
    try {
      const std::vector<Row> rows = measure.run(arguments.inputs);
      print(std::cout, rows);
      all.insert(all.end(), rows.begin(), rows.end());
    } catch (const Missing& missing) {
      std::cout << measure.name << ": skipped, there is no " << missing.what << std::endl;
    }
  }
  print_sum(std::cout, all);
}

}  // namespace

int main(int count, char** words) {
  emberfold::core::keep_freed_memory();  // as the command does
  try {
    run(parse({words + 1, words + count}));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "sketch_figures: " << error.what() << '\n';
    return 1;
  }
}
