// SPDX-License-Identifier: Apache-2.0
#include "apps/commands/dytex_em.hpp"

#include <sstream>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/commands/dytex.hpp"
#include "core/clip.hpp"
#include "core/io/mask_file.hpp"

namespace emberfold::apps {

void add_em_options(CLI::App& command, EmRequest& asked) {
  command.add_flag("--em", asked.em, "Improve the closed form to the most likely model, by EM");
  command.add_option("--missing", asked.missing, "Ignore CLIP where this clip is not 0 (implies --em)")
      ->type_name("MASK");
  command
      .add_option("--filled", asked.filled,
                  "Write CLIP with the ignored pixels filled in: .mp4, .avi, folder")
      ->type_name("OUT");
}

void check_em(const EmRequest& asked, const dytex::LearnOptions& learning) {
  if (asked.is_needed()) {
    const auto refuse = [](const std::string& option) {
      throw Misuse("EM goes on from a closed form of " + option + " alone");
    };
    if (learning.method != dytex::Method::closed_form) refuse("--method closed-form");
    if (learning.noise_rank != 0) refuse("learn.noise_rank=0");
  }
  if (!asked.filled.empty() && asked.missing.empty())
    throw Misuse("--filled needs --missing, which says what to fill in");
}

EmStage::EmStage(const EmRequest& asked, core::FrameSource& source, const io::ReadOptions& read,
                 Session& session)
    : asked_(asked), source_(source), session_(session) {
  if (asked.missing.empty()) return;
  io::ReadOptions reading = read.beside();
  reading.grey = true;
  const bool is_lossy = read.scale != 1 || io::is_lossy_mask(asked.missing);
  io::MaskSource mask(open_clip(asked.missing, reading, session), is_lossy);
  try {
    missing_ = dytex::Missing(mask, source.info(), session.context);
    session.check_stop();
    held_ = std::make_unique<dytex::HeldSource>(source, missing_, session.context);
    session.check_stop();
  } catch (const core::InputError& error) {
    throw Misuse("--missing " + asked.missing + ": " + error.what());
  }
  if (held_->never_seen() > 0)
    session.warn(std::to_string(held_->never_seen()) +
                 (held_->never_seen() == 1 ? " pixel is" : " pixels are") + " hidden in every frame");
}

void EmStage::improve(dytex::LinearDynamicTexture& texture) {
  if (!asked_.is_needed()) return;
  dytex::EmResult result;
  try {
    result = dytex::maximise_likelihood(source_, texture, {}, missing_, session_.context);
  } catch (const core::InputError& error) {
    throw Misuse("--em: " + without_struct_name(error.what()));
  }
  for (const auto& note : result.notes) session_.warn(note);
  texture = std::move(result.texture);
  const auto& log = result.log_likelihood;
  figures_ = {{"iterations", log.empty() ? 0 : log.size() - 1},
              {"converged", result.converged},
              {"log_likelihood", log},
              {"likelihood_r", result.likelihood_r},
              {"passes", result.passes},
              {"options",
               {{"missing", asked_.missing.empty() ? nlohmann::ordered_json(nullptr)
                                                   : nlohmann::ordered_json(asked_.missing)}}}};
  if (log.size() < 2) return;
  std::ostringstream said;
  said.precision(10);
  for (std::size_t i = 0; i < log.size(); ++i) said << (i > 0 ? "\n" : "") << "log-likelihood " << log[i];
  session_.console.say(said.str());
}

void EmStage::write_filled(const dytex::LinearDynamicTexture& texture) {
  if (asked_.filled.empty()) return;
  const auto writer = create_output(asked_.filled, source_.info());
  dytex::FilledSource filled(source_, missing_, texture);
  filled.rewind();
  const double frames = static_cast<double>(texture.states.cols());
  int t = 0;
  for (cv::Mat frame = filled.next(); !frame.empty(); frame = filled.next()) {
    session_.check_stop();
    session_.context.report("fill", t++ / frames);
    writer->write(core::to_bytes(core::to_levels(frame, source_.info())));
  }
  writer->finish();
  session_.console.say("the filled clip is " + asked_.filled);
}

}  // namespace emberfold::apps
