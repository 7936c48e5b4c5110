// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/pictures/png.hpp"
#include "apps/textures/classification.hpp"
#include "apps/textures/texture_samples.hpp"
#include "core/io/staged_output.hpp"
#include "core/text/join_names.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Classify {
  std::string folder, output, blocks = "1x1";
  ReadingWords reading;
  SampleOptions options;
  int folds = 0;
};

// "3x2": columns and rows.
void parse_blocks(const std::string& text, SampleOptions& options) {
  const auto cross = text.find('x');
  try {
    if (cross == std::string::npos) throw Misuse("");
    parse_number("--blocks", text.substr(0, cross), options.columns);
    parse_number("--blocks", text.substr(cross + 1), options.rows);
  } catch (const Misuse&) {
    throw Misuse("--blocks is " + one_line(text) + "; it must be COLUMNSxROWS, such as 2x2");
  }
}

void check(Classify& asked, const Session& session) {
  parse_blocks(asked.blocks, asked.options);
  asked.options.reading = check_reading(asked.reading, asked.options.reading, session);
  try {
    asked.options.validate();
  } catch (const core::InputError& error) {
    const std::string message = without_struct_name(error.what());
    if (message.starts_with("columns") || message.starts_with("rows")) throw Misuse("--blocks: " + message);
    misuse(message, {"pieces", "components", "scale"}, "");
  }
  if (asked.folds < 0 || asked.folds == 1)
    throw Misuse("--folds is " + std::to_string(asked.folds) +
                 "; allowed is 0 (a fold for every clip) or 2 and more");
}

struct Found {
  LabelledClips labelled;
  TextureSamples samples;
  SampleLabels labels;
  std::vector<std::size_t> clip_folds;
  std::vector<Recognition> results;
};

// Folds are dealt by clip, so that all samples of a clip are in one fold.
void deal(const Classify& asked, Found& found) {
  std::vector<std::size_t> clip_labels;
  for (const auto& clip : found.labelled.clips) clip_labels.push_back(clip.label);
  try {
    found.clip_folds = deal_folds(clip_labels, static_cast<std::size_t>(asked.folds));
  } catch (const core::InputError& error) {
    throw Misuse(with_option_name(error.what(), "folds"));
  }
}

void label(Found& found) {
  found.labels.classes = found.labelled.classes.size();
  for (const auto& sample : found.samples.samples) {
    found.labels.label.push_back(found.labelled.clips[sample.clip].label);
    found.labels.fold.push_back(found.clip_folds[sample.clip]);
  }
}

Json classification_json(const Found& found) {
  Json clips = Json::array(), methods = Json::array();
  for (std::size_t i = 0; i < found.labelled.clips.size(); ++i) {
    const auto& clip = found.labelled.clips[i];
    clips.push_back({{"path", clip.path.string()},
                     {"class", found.labelled.classes[clip.label]},
                     {"model", clip.model},
                     {"fold", found.clip_folds[i]}});
  }
  for (const auto& result : found.results) {
    Json rows = Json::array();
    for (int i = 0; i < result.confusion.rows; ++i) {
      Json row = Json::array();
      for (int j = 0; j < result.confusion.cols; ++j)
        row.push_back(static_cast<int>(result.confusion.at<double>(i, j)));
      rows.push_back(std::move(row));
    }
    methods.push_back({{"measure", name(result.measure)},
                       {"classifier", name(result.classifier)},
                       {"samples", result.samples},
                       {"accuracy", result.accuracy},
                       {"confusion", std::move(rows)}});
  }
  std::size_t largest = 0;
  for (std::size_t c = 0; c < found.labels.classes; ++c)
    largest = std::max(largest, static_cast<std::size_t>(std::ranges::count(found.labels.label, c)));
  return {{"format", "emberfold.texture_classification"},
          {"version", 1},
          {"classes", found.labelled.classes},
          {"clips", std::move(clips)},
          {"samples", found.labels.label.size()},
          {"largest_class_share", double(largest) / double(found.labels.label.size())},
          {"methods", std::move(methods)}};
}

std::string predictions_csv(const Found& found) {
  std::ostringstream out;
  out << "sample,class,fold";
  for (const auto& result : found.results)
    out << ',' << name(result.measure) << ' ' << name(result.classifier);
  out << '\n';
  const auto field = [](std::string text) {
    for (auto at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
      text.insert(at, 1, '"');
    return '"' + text + '"';
  };
  const auto& classes = found.labelled.classes;
  for (std::size_t i = 0; i < found.samples.samples.size(); ++i) {
    out << field(found.samples.samples[i].name) << ',' << field(classes[found.labels.label[i]]) << ','
        << found.labels.fold[i];
    for (const auto& result : found.results)
      out << ',' << (result.predicted[i] ? field(classes[*result.predicted[i]]) : "");
    out << '\n';
  }
  return out.str();
}

std::string accuracy_table(const Found& found) {
  std::string out = std::to_string(found.labels.label.size()) + " samples of " +
                    std::to_string(found.labelled.clips.size()) + " clips in " +
                    std::to_string(found.labelled.classes.size()) + " classes; recognised, %\n" +
                    "                nearest       svm\n";
  for (const auto measure : dytex::kMeasures) {
    std::string line;
    std::size_t samples = 0;
    for (const auto classifier : {Classifier::nearest, Classifier::svm})
      for (const auto& result : found.results)
        if (result.measure == measure && result.classifier == classifier) {
          std::array<char, 32> text{};
          std::snprintf(text.data(), text.size(), "%10.1f", 100 * result.accuracy);
          line += text.data();
          samples = result.samples;
        }
    std::string name = dytex::name(measure);
    name.resize(13, ' ');
    out += name + (line.empty() ? "         -         -" : line);
    if (samples < found.labels.label.size()) out += "   of " + std::to_string(samples) + " samples";
    out += "\n";
  }
  return out;
}

// Warns of samples that a measure omits.
void warn_missing(const Found& found, Session& session) {
  constexpr std::size_t kMostNames = 5;
  std::vector<std::string> noiseless, still, windowless;
  for (std::size_t i = 0; i < found.samples.samples.size(); ++i) {
    const auto& texture = found.samples.textures[i];
    if (!dytex::has_noise(texture)) noiseless.push_back(found.samples.samples[i].name);
    if (texture.order() == 0) still.push_back(found.samples.samples[i].name);
    if (!found.samples.windows.empty() && !found.samples.windows[i])
      windowless.push_back(found.samples.samples[i].name);
  }
  if (!noiseless.empty())
    session.warn(core::join_names(noiseless, kMostNames) +
                 ": the noise r is 0, so there is no KL rate and KL leaves it out; learn it with fewer "
                 "components, so that r is estimated");
  if (!still.empty())
    session.warn(core::join_names(still, kMostNames) +
                 ": no components, so angles and Martin's distance leave it out");
  if (!windowless.empty())
    session.warn(core::join_names(windowless, kMostNames) +
                 ": no windows of 16x16 that move for 32 frames, so windows leave it out");
}

void run_classify(Classify asked, Session& session) {
  check(asked, session);
  const auto warn = [&](const std::string& text) { session.warn(text); };
  Found found;
  found.labelled = list_labelled(asked.folder, warn);
  deal(asked, found);
  std::vector<std::string> inputs{asked.folder};
  for (const auto& clip : found.labelled.clips) {
    inputs.push_back(clip.path.string());
    inputs.push_back(clip.path.parent_path().string());
  }
  require_apart(inputs, asked.output, {"confusion.png"}, session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs);
  Stages stages;
  stages.begin("learn");
  found.samples = learn_samples(found.labelled, asked.options, session, warn);
  label(found);
  stages.begin("distances");
  const auto pairs = dytex::all_distances(found.samples.textures, session.context, found.samples.windows);
  session.check_stop();
  stages.begin("classify");
  found.results = cross_validate(found.labels, pairs);
  warn_missing(found, session);
  stages.end();
  const Json content = classification_json(found);
  output.write("classification.json", [&](std::ostream& out) { out << json_text(content); });
  output.write("predictions.csv", [&](std::ostream& out) { out << predictions_csv(found); });
  write_png(output, "confusion.png", draw_recognition(found.labelled.classes, found.results));
  Json summary = begin_summary("dytex classify", session);
  summary["options"] = {{"blocks", asked.blocks},
                        {"pieces", asked.options.pieces},
                        {"components", asked.options.components},
                        {"folds", asked.folds},
                        {"reading", reading_json(asked.options.reading)}};
  for (const auto& [key, value] : content.items())
    if (key != "format" && key != "version") summary[key] = value;
  end_summary(summary, session, stages);
  write_summary(output, summary);
  session.check_stop();
  output.commit();
  session.print(session.common.json ? json_text(summary) : accuracy_table(found));
}

}  // namespace

void add_dytex_classify(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(
      dytex, "classify", "Classify clips of several classes by their textures, with cross-validation", R"(
  emberfold dytex classify clips -o out/classes
  emberfold dytex classify clips -o out/classes --blocks 2x2 --pieces 2 -n 15 --grey)");
  const auto asked = std::make_shared<Classify>();
  command->add_option("FOLDER", asked->folder, "Read a folder for each class, with its clips or their models")
      ->required()
      ->type_name("");
  add_output(*command, asked->output);
  command->add_option("--blocks", asked->blocks, "Cut frames into this many blocks, each a sample")
      ->type_name("CxR")
      ->default_str(asked->blocks);
  add_number(*command, "--pieces", asked->options.pieces, "N",
             "Cut clips into this many pieces of equal length");
  add_number(*command, "-n,--components", asked->options.components, "N", "Learn this many components");
  add_number(*command, "--folds", asked->folds, "N", "Use this many folds; 0: leave out each clip in turn");
  add_reading_options(*command, asked->reading, asked->options.reading);
  finish_command(*command, line, asked, run_classify);
}

}  // namespace emberfold::apps
