// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/pictures/png.hpp"
#include "apps/textures/texture_distances.hpp"
#include "core/io/staged_output.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
using dytex::Measure;

struct Distance {
  std::vector<std::string> models;
  std::string output, measure = "kl";
  int growth = 0;
  bool asked_growth = false, asked_measure = false;
};

Measure check(const Distance& asked) {
  constexpr int kLongest = 100'000;
  const auto measure = measure_of(asked.measure);
  if (!measure) throw Misuse("--measure is " + one_line(asked.measure) + "; allowed is " + measure_names());
  if (asked.asked_growth && (asked.growth < 1 || asked.growth > kLongest))
    throw Misuse("--growth is " + std::to_string(asked.growth) + "; allowed is 1 to " +
                 std::to_string(kLongest));
  if (asked.asked_growth && asked.output.empty())
    throw Misuse("--growth writes growth.json and growth.png: name a folder for them with --output");
  if (asked.models.size() < 2) throw Misuse("one model has no distance; name two models or more");
  return *measure;
}

std::vector<dytex::LinearDynamicTexture> read_models(const std::vector<std::string>& folders) {
  std::vector<dytex::LinearDynamicTexture> models;
  for (const auto& folder : folders) {
    models.push_back(read_texture(folder));
    const auto &a = models.front().info, &b = models.back().info;
    if (a.width == b.width && a.height == b.height && a.channels == b.channels) continue;
    const auto text = [](const core::ClipInfo& info) {
      return std::to_string(info.width) + " x " + std::to_string(info.height) +
             (info.channels == 3 ? " in colour" : " in grey");
    };
    throw core::IoError(folder + " has frames of " + text(b) + ", " + folders.front() + " of " + text(a) +
                        "; models of different frames cannot be compared");
  }
  return models;
}

// Warns of what a model lacks for a distance. Throws where KL was requested and no pair has it.
void warn_missing(const Distance& asked, const std::vector<dytex::LinearDynamicTexture>& models,
                  Session& session) {
  const bool asked_kl = asked.asked_growth || (asked.asked_measure && asked.measure == "kl");
  const auto noisy = std::ranges::count_if(models, dytex::has_noise);
  const bool no_curve = asked.asked_growth && !dytex::has_noise(models.front());
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!dytex::has_noise(models[i])) {
      if (asked_kl && (noisy < 2 || (no_curve && i == 0)))
        throw core::IoError(asked.models[i] +
                            ": its noise r is 0, so the KL rate is infinite; learn it with fewer "
                            "components, so that r is estimated");
      session.warn(asked.models[i] +
                   ": its noise r is 0, so pairs with it have no KL rate; learn it with fewer components, "
                   "so that r is estimated");
    }
    if (models[i].order() == 0)
      session.warn(asked.models[i] + ": it has no components, so there are no angles");
  }
}

// Returns the curves of two models in both directions; of more, from the first to each other one that has
// noise.
std::vector<Growth> growths(const Distance& asked, const std::vector<std::string>& names,
                            const std::vector<dytex::LinearDynamicTexture>& models, const Session& session) {
  std::vector<std::pair<std::size_t, std::size_t>> ways;
  for (std::size_t j = 1; j < models.size(); ++j)
    if (dytex::has_noise(models[j])) ways.emplace_back(0, j);
  if (models.size() == 2) ways.emplace_back(1, 0);
  std::vector<Growth> curves;
  for (const auto& [i, j] : ways) {
    const Eigen::VectorXd values = dytex::kl_growth(models[i], models[j], asked.growth, session.context);
    session.check_stop();
    curves.push_back(
        {names[i], names[j], dytex::kl_rate(models[i], models[j]), {values.begin(), values.end()}});
  }
  return curves;
}

void run_distance(const Distance& asked, Session& session) {
  const Measure measure = check(asked);
  const auto names = short_names(asked.models);
  std::optional<io::OutputFolder> output;
  if (!asked.output.empty()) {
    require_apart(asked.models, asked.output, {}, session.common);
    output.emplace(asked.output, session.common.existing());
    output->protect(asked.models);
  }
  Stages stages;
  stages.begin("read");
  const auto models = read_models(asked.models);
  warn_missing(asked, models, session);
  stages.begin("distances");
  const auto pairs = dytex::all_distances(models, session.context);
  session.check_stop();
  const cv::Mat values = measure_matrix(pairs, measure);
  Json found = distances_json(asked.models, pairs);
  if (output) {
    output->write("matrix.json", [&](std::ostream& out) { out << json_text(found); });
    output->write("matrix.csv", [&](std::ostream& out) { out << matrix_csv(names, values); });
    write_png(*output, "matrix.png", draw_distances(names, values, measure));
    if (asked.asked_growth) {
      stages.begin("growth");
      const auto curves = growths(asked, names, models, session);
      output->write("growth.json", [&](std::ostream& out) { out << json_text(growth_json(curves)); });
      write_png(*output, "growth.png", draw_growth(curves));
      found["growth"] = growth_json(curves)["curves"];
    }
    output->commit();
    session.console.say("the distances are in " + asked.output);
  }
  stages.end();
  if (session.common.json) {
    Json summary = begin_summary("dytex distance", session);
    for (const auto& [key, value] : found.items())
      if (key != "format" && key != "version") summary[key] = value;
    summary["warnings"] = session.warnings;
    summary["seconds"] = stages.seconds();
    session.print(json_text(summary));
  } else if (models.size() == 2 && !asked.asked_measure) {
    session.print(pair_table(names, pairs[1]));
  } else {
    session.print(matrix_table(names, values, measure));
  }
}

}  // namespace

void add_dytex_distance(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "distance", "Measure the distances of linear dynamic textures", R"(
  emberfold dytex distance out/flag out/river
  emberfold dytex distance out/flag out/river -o out/apart --growth 200
  emberfold dytex distance out/*/texture -o out/matrix --measure martin)");
  const auto asked = std::make_shared<Distance>();
  command->add_option("MODEL", asked->models, "Read the models from these folders, two or more")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", asked->output,
                   "Write matrix.json, matrix.csv and matrix.png into this folder")
      ->type_name("DIR");
  auto* measure =
      command->add_option("--measure", asked->measure, "Show this distance in table, CSV and picture")
          ->type_name("kl|martin|angles|windows")
          ->default_str(asked->measure);
  auto* growth = add_number(*command, "--growth", asked->growth, "FRAMES",
                            "Write growth.json, growth.png: KL divergence by frames")
                     ->default_str("");
  finish_command(*command, line, asked, run_distance, [asked, measure, growth] {
    asked->asked_measure = measure->count() > 0;
    asked->asked_growth = growth->count() > 0;
  });
}

}  // namespace emberfold::apps
