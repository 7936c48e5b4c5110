// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <thread>

#include <nlohmann/json.hpp>

#include "apps/batch/batch_manifest.hpp"
#include "apps/batch/batch_plan.hpp"
#include "apps/batch/child_process.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/analyze_options.hpp"
#include "core/fingerprint.hpp"
#include "core/io/clip_identity.hpp"
#include "core/io/files.hpp"
#include "core/io/require_apart.hpp"
#include "core/io/scratch.hpp"

namespace emberfold::apps {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Batch : AskedAnalysis {
  std::vector<std::string> clips;
  std::string output;
  int jobs = 1;
  std::vector<std::string> words;  ///< command-line words passed to each analyze
};

/// Selects the analysis options from the typed words: no clip, no option of batch itself or of its output.
std::vector<std::string> words_to_pass(const CLI::App& command, const std::vector<std::string>& typed) {
  std::vector<std::string> kept;
  const auto is_batch_own = [](const std::string& name) {
    return name == "-o" || name == "--output" || name == "--jobs" || name == "--json" || name == "-q" ||
           name == "--quiet" || name == "--threads" || name == "--progress";
  };
  for (std::size_t i = 1; i < typed.size(); ++i) {
    const auto& word = typed[i];
    if (!word.starts_with("-") || word == "--" || word == "-") continue;
    const bool is_short = !word.starts_with("--");
    const auto equals = word.find('=');
    const std::string name = is_short ? word.substr(0, 2) : word.substr(0, equals);
    const auto* const option = command.get_option_no_throw(name);
    const bool is_flag = option == nullptr || option->get_items_expected_max() == 0;
    const bool has_own_value = is_short ? word.size() > 2 : equals != std::string::npos;
    const bool takes_next = !is_flag && !has_own_value && i + 1 < typed.size();
    if (!is_batch_own(name)) {
      kept.push_back(word);
      if (takes_next) kept.push_back(typed[i + 1]);
    }
    if (takes_next) ++i;
  }
  return kept;
}

/// Returns a hash of everything that a run depends on.
std::string run_key(const Batch& asked, const std::string& clip) {
  core::Fingerprint sum;
  sum.add(kVersion).add(clip.starts_with("builtin:") ? clip : io::clip_identity(clip));
  sum.add(io::clip_identity(asked.reading.options.mask));
  for (const auto& word : asked.words)
    if (word != "--overwrite") sum.add(word);
  return sum.text();
}

/// Returns the last line of a process's messages: the reason for its failure.
std::string last_line(const fs::path& log) {
  constexpr std::string_view kHead = "emberfold: ";
  std::ifstream in(log);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return one_line(last.starts_with(kHead) ? last.substr(kHead.size()) : last);
}

/// The clips that are being analysed, and those that wait.
class Queue {
 public:
  Queue(const Batch& asked, std::vector<BatchEntry>& entries, std::vector<std::size_t> waiting,
        Session& session)
      : asked_(asked), entries_(entries), waiting_(std::move(waiting)), session_(session) {}

  /// Analyses all waiting clips, until the user asks to stop.
  void run() {
    const std::size_t all = waiting_.size();
    while (next_ < all || !running_.empty()) {
      if (session_.context.cancelled()) {
        for (const auto& one : running_) one.process->stop();
        return;  // ~ChildProcess waits for them to end
      }
      while (next_ < all && running_.size() < static_cast<std::size_t>(asked_.jobs)) start(waiting_[next_++]);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      std::erase_if(running_, [&](Running& one) { return note_end(one); });
      session_.context.report("clips",
                              static_cast<double>(next_ - running_.size()) / static_cast<double>(all));
    }
  }

 private:
  struct Running {
    std::size_t entry;
    fs::path log;
    Clock::time_point began;
    std::unique_ptr<ChildProcess> process;
  };

  void start(std::size_t index) {
    const auto& entry = entries_[index];
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    const int threads = session_.common.threads > 0 ? session_.common.threads : static_cast<int>(cores);
    const std::string folder = (fs::path(asked_.output) / entry.run).string();
    std::vector<std::string> arguments{"analyze", entry.clip, "-o", folder, "--quiet", "--threads"};
    arguments.push_back(std::to_string(std::max(1, threads / asked_.jobs)));
    arguments.insert(arguments.end(), asked_.words.begin(), asked_.words.end());
    const auto log = io::scratch_path(asked_.output, ".log");
    running_.push_back({index, log, Clock::now(), std::make_unique<ChildProcess>(arguments, log)});
  }

  bool note_end(Running& one) {
    const auto end = one.process->ended();
    if (!end) return false;
    auto& entry = entries_[one.entry];
    entry.seconds = std::round(std::chrono::duration<double>(Clock::now() - one.began).count() * 100) / 100;
    entry.exit = end->exit;
    entry.state = end->exit == 0 ? "done" : "failed";
    entry.message = end->exit == 0 ? "" : last_line(one.log);
    if (end->by_signal)
      entry.message = "ended by signal " + std::to_string(end->exit - 128) +
                      (entry.message.empty() ? "" : "; last told: " + entry.message);
    std::error_code ignored;
    fs::remove(one.log, ignored);
    write_manifest(asked_.output, entries_);
    if (end->exit != 0)
      session_.console.warn(entry.clip + ": " + entry.message);
    else
      session_.console.say(entry.clip + ": done in " + duration_text(entry.seconds));
    return true;
  }

  const Batch& asked_;
  std::vector<BatchEntry>& entries_;
  std::vector<std::size_t> waiting_;
  Session& session_;
  std::size_t next_ = 0;
  std::vector<Running> running_;
};

/// Merges the plan with the state of an earlier call; returns the entries that wait.
std::vector<std::size_t> merge_plan(const Batch& asked, const std::vector<PlannedRun>& plan,
                                    std::vector<BatchEntry>& entries) {
  std::map<std::string, BatchEntry> known;
  for (auto& entry : entries) known.emplace(entry.run, std::move(entry));
  std::vector<std::string> wanted;
  for (const auto& run : plan) {
    auto& entry = known[run.name];
    const auto key = run_key(asked, run.clip);
    std::error_code error;
    const bool is_done = entry.state == "done" && entry.key == key &&
                         fs::exists(fs::path(asked.output) / run.name / "summary.json", error);
    if (is_done) continue;
    entry = {run.name, run.clip, "waiting", key, 0, 0, {}};
    wanted.push_back(run.name);
  }
  entries.clear();
  std::vector<std::size_t> waiting;
  for (auto& [name, entry] : known) {
    if (std::ranges::find(wanted, name) != wanted.end()) waiting.push_back(entries.size());
    entries.push_back(std::move(entry));
  }
  return waiting;
}

std::vector<PlannedRun> check_batch(const Batch& asked, const Session& session) {
  check_analysis(asked, session);
  if (asked.jobs < 1 || asked.jobs > 1024)
    throw Misuse("--jobs is " + std::to_string(asked.jobs) + "; allowed is 1 to 1024");
  std::vector<PlannedRun> plan;
  try {
    plan = plan_runs(asked.clips);
  } catch (const core::InputError& error) {
    throw Misuse(error.what());
  }
  std::vector<std::string> inputs{asked.reading.options.mask};
  std::vector<io::OutputPath> outputs;
  for (const auto& run : plan) {
    inputs.push_back(run.clip);
    outputs.push_back({fs::path(asked.output) / run.name, true});
  }
  io::require_apart(inputs, outputs);
  return plan;
}

void run_batch(const Batch& asked, Session& session) {
  const auto plan = check_batch(asked, session);
  io::make_folder(asked.output);
  const BatchLock lock(asked.output);
  auto entries = read_manifest(asked.output);
  const auto waiting = merge_plan(asked, plan, entries);
  write_manifest(asked.output, entries);
  const auto count = [&](const char* state) {
    return std::ranges::count_if(plan, [&](const PlannedRun& run) {
      return std::ranges::any_of(
          entries, [&](const auto& entry) { return entry.run == run.name && entry.state == state; });
    });
  };
  const std::string of_all = " of " + std::to_string(plan.size()) + " clips ";
  if (const auto before = plan.size() - waiting.size(); before > 0)
    session.console.say(std::to_string(before) + of_all + "were done before");
  { Queue(asked, entries, waiting, session).run(); }
  if (session.context.cancelled())
    throw core::Cancelled(std::to_string(count("done")) + of_all + "are done in " + asked.output +
                          "; the same command goes on");
  if (session.common.json) session.print(json_text(manifest_json(entries)));
  const std::string list = (fs::path(asked.output) / kBatchFile).string();
  if (const auto failed = count("failed"); failed > 0)
    throw core::IoError(std::to_string(failed) + of_all + "failed; " + list +
                        " tells why, the same command tries again");
  session.console.say(std::to_string(plan.size()) + " clips are done; 'emberfold runs gather " +
                      asked.output + "' makes one table of them");
}

}  // namespace

void add_batch(CLI::App& runs, CommandLine& line) {
  auto* command =
      add_command(runs, "batch", "Analyse many clips, each into a folder of its own; can be resumed", R"(
  emberfold runs batch 'clips/*.avi' -o runs --jobs 2
  emberfold runs batch clips/wild clips/mutant -o runs --pixel-size 0.065um --fps 30)");
  const auto asked = std::make_shared<Batch>();
  command->add_option("CLIPS", asked->clips, "Clips, folders of clips, or patterns in quotes")
      ->required()
      ->type_name("");
  add_output(*command, asked->output);
  add_number(*command, "--jobs", asked->jobs, "N", "Analyse N clips at once; they share the threads");
  add_reading_options(*command, asked->reading.words, asked->reading.options);
  add_analysis_options(*command, *asked, line);
  finish_command(*command, line, asked, run_batch,
                 [asked, command, &line] { asked->words = words_to_pass(*command, line.words); });
}

}  // namespace emberfold::apps
