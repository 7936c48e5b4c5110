// SPDX-License-Identifier: Apache-2.0
// `dytex learn` by stripes of the frames: on the ranks of a job, or on one process by blocks of frames.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex_learn.hpp"
#include "apps/distributed/component_file.hpp"
#include "apps/distributed/mpi_job.hpp"
#include "apps/distributed/stripe_files.hpp"
#include "core/error.hpp"
#include "core/fingerprint.hpp"
#include "core/io/clip_identity.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/require_apart.hpp"
#include "core/io/tiff_pages.hpp"
#include "dytex/distributed/learn_distributed.hpp"
#include "dytex/distributed/together.hpp"
#include "dytex/model/archive_parts.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr Eigen::Index kDrawnComponents = 11;  // maximum number that write_components uses

/// Header that rank 0 broadcasts.
struct Told {
  int width = 0, height = 0, channels = 1, depth = 0;
  double fps = 25, white = 255;
  std::int64_t frames = -1;  // unknown
  int fps_is_known = 1, readers = 1, components = 1;
  std::int64_t folder = 0, output = 0;  // lengths of the two paths that follow
};

core::ClipInfo info_of(const Told& told) {
  core::ClipInfo info{told.width, told.height, told.channels, told.depth, told.fps, told.white};
  if (told.frames >= 0) info.frames = told.frames;
  info.fps_is_known = told.fps_is_known != 0;
  return info;
}

/// Returns whether a frame can be read without reading those before it.
bool any_frame_at_once(const std::string& clip) {
  std::error_code error;
  if (clip.starts_with("builtin:")) return true;
  if (fs::is_directory(clip, error)) return true;
  if (!fs::exists(clip, error)) return io::is_pattern(clip);
  return fs::is_regular_file(clip, error) && io::is_tiff(clip);
}

/// Returns the number of ranks that may read. One reads everything where the white level of floats has to be
/// found, or motion is tracked.
int reader_count(const std::string& clip, const io::ReadOptions& read, const core::ClipInfo& info,
                 int ranks) {
  const bool looked_for = info.depth == CV_32F && read.levels.kind != io::Levels::Kind::given;
  const bool alone = read.stabilize != io::Stabilize::none || looked_for || !info.frames;
  return any_frame_at_once(clip) && !alone ? ranks : 1;
}

fs::path kept_folder(const std::string& output) {
  fs::path path = fs::absolute(output).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return path.string() + ".learning";
}

/// Returns a key that changes with everything that the stored work depends on.
std::string work_key(const TextureLearning& asked, const io::ReadOptions& read, const core::ClipInfo& info) {
  core::Fingerprint sum;
  std::string clip = io::clip_identity(asked.reading.clip);
  if (asked.reading.clip.starts_with("builtin:")) clip = asked.reading.clip + std::to_string(read.seed);
  if (clip.empty())  // a pipe cannot be read again
    clip = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  sum.add(kVersion).add(clip).add(reading_json(read).dump()).add(std::to_string(asked.block));
  sum.add(std::to_string(info.width) + "x" + std::to_string(info.height) + " " +
          std::to_string(info.channels) + " " + std::to_string(info.depth));
  sum.add(std::to_string(asked.options.components) + (asked.options.energy ? " of a share" : ""));
  return sum.text();
}

void refuse_what_needs_one(const TextureLearning& asked) {
  const auto refuse = [](const std::string& option) {
    throw Misuse(option + " is not there under mpirun or with learn.block");
  };
  if (!asked.mask.empty()) refuse("--mask");
  if (!asked.em.missing.empty()) refuse("--missing");
  if (asked.em.is_needed()) refuse("--em");
}

/// Runs the command on one rank. Its steps are called in turn, each on all ranks.
class LearningRank {
 public:
  LearningRank(TextureLearning asked, Session& session, dytex::Communicator& ranks)
      : asked_(std::move(asked)), session_(session), ranks_(ranks) {}

  /// Checks the request; rank 0 opens clip and output, and broadcasts the result.
  void begin() {
    stages_.begin("learn");
    dytex::together(ranks_, [&] {
      read_ = check_learning(asked_, session_);
      refuse_what_needs_one(asked_);
      io::require_apart({asked_.reading.clip}, {{asked_.output}});
    });
    dytex::together(ranks_, [&] {
      if (!is_root()) return;
      folder_.emplace(asked_.output);
      source_ = open_held_clip(asked_.reading.clip, read_, session_);
      fit_to_length(asked_, source_->info(), session_);
      info_ = source_->info();
      folder_path_ = kept_folder(asked_.output).string();
      resumed_ = begin_kept_work(folder_path_, work_key(asked_, read_, info_));
      C_path_ = fs::absolute(folder_->output().staged("C.npy")).string();
      readers_ = reader_count(asked_.reading.clip, read_, info_, ranks_.ranks());
    });
    tell();
    dytex::together(ranks_, [&] {
      if (is_root() || ranks_.rank() >= readers_) return;
      source_ = open_held_clip(asked_.reading.clip, read_, core::Warn());
      const core::ClipInfo& found = source_->info();
      if (found.width != info_.width || found.height != info_.height || found.channels != info_.channels ||
          found.depth != info_.depth || found.frames != info_.frames)
        throw core::IoError(asked_.reading.clip + " is another clip here than on rank 0");
    });
  }

  void learn() {
    if (resumed_) session_.console.say("going on with what is kept in " + folder_path_);
    StripeFiles keeper(folder_path_);
    const ComponentFile file(C_path_, values());
    const dytex::RowSink rows{[&](Eigen::Index n) { file.begin(n); },
                              [&](std::size_t first, const Eigen::MatrixXf& some) { file.put(first, some); }};
    const dytex::SharedClip clip{info_, readers_, ranks_.rank() < readers_ ? source_.get() : nullptr};
    result_ = dytex::learn_distributed(ranks_, clip, asked_.options, static_cast<std::size_t>(asked_.block),
                                       keeper, rows, session_.context);
  }

  /// Writes the model, and removes the stored work.
  void finish() {
    const auto sent =
        dytex::tell_together(ranks_, [&] { return static_cast<std::int64_t>(ranks_.bytes_sent()); });
    const auto decoded =
        dytex::tell_together(ranks_, [&] { return static_cast<std::int64_t>(result_.decoded); });
    dytex::together(ranks_, [&] {
      if (is_root()) write(sent, decoded);
    });
  }

  [[nodiscard]] bool is_root() const { return ranks_.rank() == 0; }
  [[nodiscard]] const TextureLearning& asked() const { return asked_; }

 private:
  [[nodiscard]] std::size_t values() const {
    return static_cast<std::size_t>(info_.width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(info_.channels);
  }

  void tell() {
    Told told{info_.width,
              info_.height,
              info_.channels,
              info_.depth,
              info_.fps,
              info_.white,
              info_.frames.value_or(-1),
              info_.fps_is_known ? 1 : 0,
              readers_,
              asked_.options.components,
              static_cast<std::int64_t>(folder_path_.size()),
              static_cast<std::int64_t>(C_path_.size())};
    dytex::broadcast(ranks_, std::as_writable_bytes(std::span(&told, 1)));
    folder_path_.resize(static_cast<std::size_t>(told.folder));
    C_path_.resize(static_cast<std::size_t>(told.output));
    dytex::broadcast(ranks_, std::as_writable_bytes(std::span(folder_path_)));
    dytex::broadcast(ranks_, std::as_writable_bytes(std::span(C_path_)));
    if (is_root()) return;
    info_ = info_of(told);
    readers_ = told.readers;
    asked_.options.components = told.components;
  }

  void write(const std::vector<std::int64_t>& sent, const std::vector<std::int64_t>& decoded) {
    dytex::LearnResult& learned = result_.learned;
    dytex::LinearDynamicTexture& texture = learned.texture;
    for (const auto& note : learned.notes) session_.warn(note);
    stages_.begin("write");
    io::write_model(folder_->output(), "", dytex::archive_view_without_C(texture));
    const Eigen::Index n = texture.components();
    Json summary = learn_summary(asked_, read_, source_->info(), learned, session_);
    summary["texture"]["parameters"] = summary["texture"]["parameters"].get<double>() +
                                       static_cast<double>(values()) * static_cast<double>(n);
    texture.C = ComponentFile(C_path_, values()).first_columns(std::min(n, kDrawnComponents), n);
    write_components(folder_->output(), texture);
    stages_.end();
    summary["learning"]["distributed"] = {{"ranks", ranks_.ranks()}, {"readers", readers_},
                                          {"block", result_.block},  {"resumed_frames", result_.resumed},
                                          {"bytes_sent", sent},      {"frames_decoded", decoded}};
    end_summary(summary, session_, stages_);
    write_summary(folder_->output(), summary);
    session_.check_stop();
    folder_->commit();
    std::error_code ignored;
    fs::remove_all(folder_path_, ignored);
    texture.C.resize(0, n);
    say_learned(asked_, texture, session_);
    if (session_.common.json) session_.print(json_text(summary));
  }

  TextureLearning asked_;
  Session& session_;
  dytex::Communicator& ranks_;
  Stages stages_;
  io::ReadOptions read_;
  std::optional<io::ModelFolder> folder_;
  std::unique_ptr<core::FrameSource> source_;
  core::ClipInfo info_;
  std::string folder_path_, C_path_;
  int readers_ = 1;
  bool resumed_ = false;
  dytex::DistributedResult result_;
};

/// Throws on rank 0, for all ranks, the error that one of them met.
void speak(const dytex::FailedTogether& failed, const TextureLearning* learning) {
  const std::string who = failed.rank() > 0 ? " (rank " + std::to_string(failed.rank()) + ")" : "";
  try {
    failed.rethrow();
  } catch (const core::InputError& error) {
    throw Misuse(learning != nullptr ? learning_message(*learning, error.what()) : error.what());
  } catch (const core::IoError& error) {
    throw core::IoError(error.what() + who);
  } catch (const core::Cancelled&) {
    throw core::Cancelled("the same command goes on from the last block");
  }
}

}  // namespace

void learn_on_ranks(const TextureLearning& asked, Session& session, MpiJob* job) {
  dytex::SingleRank alone;
  dytex::Communicator& ranks = job != nullptr ? job->ranks() : alone;
  if (ranks.rank() > 0) session.console.set_quiet(true);
  bool began = false;
  try {
    LearningRank rank(asked, session, ranks);
    rank.begin();
    began = true;
    rank.learn();
    rank.finish();
  } catch (const dytex::FailedTogether& failed) {
    // Only rank 0 reports the error and exits with a non-zero status; the launcher stops no rank before that.
    if (ranks.rank() > 0) return;
    drop_unbegun_work(kept_folder(asked.output));
    speak(failed, began ? &asked : nullptr);
  } catch (const std::exception& error) {
    if (ranks.ranks() == 1) throw;
    session.console.error("rank " + std::to_string(ranks.rank()) + ": " + error.what());
    job->abort(1);
  }
}

}  // namespace emberfold::apps
