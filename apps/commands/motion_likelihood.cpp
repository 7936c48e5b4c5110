// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <filesystem>
#include <iomanip>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "core/io/files.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/format_number.hpp"
#include "graph/io/motion_io.hpp"
#include "mcmc/inference/transition_likelihood.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Likelihood {
  std::string model, motion;
  bool csv = false;
};

constexpr std::array kTermNames = {"displacement", "contrast", "births",   "deaths",
                                   "splits",       "merges",   "connects", "disconnects"};

template <class Terms>
std::array<double, kTermNames.size()> terms_of(const Terms& gap) {
  std::array<double, kTermNames.size()> terms{gap.displacement, gap.contrast};
  for (std::size_t i = 0; i < gap.events.size(); ++i) terms[i + 2] = gap.events[i];
  return terms;
}

mcmc::MotionModel read_motion_model(const std::string& folder) {
  const auto archive = io::read_model(folder, io::kMotionFormat);
  try {
    return mcmc::motion_model(archive);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
}

graph::MotionGraph read_graphs(const std::string& name) {
  const fs::path path = fs::is_directory(name) ? fs::path(name) / "motion.jsonl" : fs::path(name);
  auto file = io::open_file(path);
  return graph::identify(graph::read_motion(file, path.string()));
}

std::vector<mcmc::TransitionLikelihood> compute(const mcmc::MotionModel& model,
                                                const graph::MotionGraph& motion, const std::string& name,
                                                const core::Context& context) {
  try {
    return mcmc::transition_likelihoods(model, motion, context);
  } catch (const core::InputError& error) {
    throw core::IoError(name + ": " + error.what());
  }
}

Json gaps_json(const Likelihood& asked, const std::vector<mcmc::TransitionLikelihood>& gaps) {
  const auto mean = mcmc::mean_transition(gaps);
  const auto object = [](const auto& gap, double total) {
    Json terms = Json::object();
    const auto values = terms_of(gap);
    for (std::size_t i = 0; i < values.size(); ++i) terms[kTermNames[i]] = values[i];
    terms["total"] = total;
    return terms;
  };
  Json result = {{"model", asked.model}, {"motion", asked.motion}, {"unit", "nats"}};
  result["mean"] = object(mean, mean.total);
  result["mean"]["motion_of_a_place"] = mean.motion_per_place;
  Json& list = result["gaps"] = Json::array();
  for (std::size_t t = 0; t < gaps.size(); ++t) {
    Json one = {{"frame", t + 1}};
    one.update(object(gaps[t], gaps[t].total()));
    one["places"] = gaps[t].places;
    one["happened"] = gaps[t].happened;
    list.push_back(std::move(one));
  }
  return result;
}

std::string gaps_csv(const std::vector<mcmc::TransitionLikelihood>& gaps) {
  std::ostringstream out;
  out << "frame";
  for (const char* name : kTermNames) out << ',' << name;
  out << ",total,places\n";
  for (std::size_t t = 0; t < gaps.size(); ++t) {
    out << t + 1;
    for (const double term : terms_of(gaps[t])) out << ',' << core::number_text(term);
    out << ',' << core::number_text(gaps[t].total()) << ',' << gaps[t].places << '\n';
  }
  return out.str();
}

std::string gaps_table(const std::vector<mcmc::TransitionLikelihood>& gaps) {
  std::ostringstream out;
  out << "log P of each frame's graph and links, given those before, nats\n frame";
  for (const char* name : kTermNames) out << std::setw(13) << name;
  out << std::setw(11) << "total\n";
  const auto row = [&](const std::string& name, const auto& gap, double total) {
    out << std::setw(6) << name;
    for (const double term : terms_of(gap)) out << std::setw(13) << core::fixed_text(term, 2);
    out << std::setw(10) << core::fixed_text(total, 2) << '\n';
  };
  for (std::size_t t = 0; t < gaps.size(); ++t) row(std::to_string(t + 1), gaps[t], gaps[t].total());
  const auto mean = mcmc::mean_transition(gaps);
  row("mean", mean, mean.total);
  out << "motion of a place: " << core::fixed_text(mean.motion_per_place, 3) << " nats\n";
  return out.str();
}

void run_likelihood(const Likelihood& asked, const Session& session) {
  if (asked.csv && session.common.json) throw Misuse("--csv and --json exclude each other");
  const auto model = read_motion_model(asked.model);
  const auto gaps = compute(model, read_graphs(asked.motion), asked.motion, session.context);
  session.check_stop();
  session.print(asked.csv             ? gaps_csv(gaps)
                : session.common.json ? json_text(gaps_json(asked, gaps))
                                      : gaps_table(gaps));
}

}  // namespace

void add_motion_likelihood(CLI::App& motion, CommandLine& line) {
  auto* command = add_command(motion, "likelihood", "Tell how likely a clip's graphs are under a model", R"(
  emberfold motion likelihood out/fire/model out/fire
  emberfold motion likelihood out/fire/model new_fire.jsonl --csv > likelihood.csv)");
  const auto asked = std::make_shared<Likelihood>();
  command->add_option("MODEL", asked->model, "Read the model from this folder, DIR/model of analyze")
      ->required()
      ->type_name("");
  command->add_option("RUN", asked->motion, "Read the graphs from this run, or motion.jsonl")
      ->required()
      ->type_name("");
  command->add_flag("--csv", asked->csv, "Print a table of comma-separated values");
  finish_command(*command, line, asked, run_likelihood);
}

}  // namespace emberfold::apps
