// SPDX-License-Identifier: Apache-2.0
#include "apps/motion_page/motion_page.hpp"

#include <filesystem>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/motion_page/motion_page_assets.hpp"
#include "apps/page/packed_text.hpp"
#include "apps/page/page_assets.hpp"
#include "apps/page/page_title.hpp"
#include "apps/report/report.hpp"
#include "core/error.hpp"
#include "core/npy.hpp"
#include "core/text/size_text.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "sketch/background/still_background.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

// Collects the bytes of a page's files, each with its offset and size.
struct PageBytes {
  std::vector<unsigned char> all;

  Json put(const unsigned char* bytes, std::size_t size) {
    const std::size_t at = all.size();
    all.insert(all.end(), bytes, bytes + size);
    return {at, size};
  }
  Json put(const std::string& text) {
    return put(reinterpret_cast<const unsigned char*>(text.data()), text.size());
  }
  Json put(const cv::Mat& bytes) {
    const cv::Mat whole = bytes.isContinuous() ? bytes : bytes.clone();
    return put(whole.ptr(), whole.total() * whole.elemSize());
  }
};

Json put_model(const mcmc::MotionModel& model, PageBytes& bytes) {
  const core::ModelArchive archive = mcmc::to_archive(model);
  Json files = {{"model.json", bytes.put(archive.text)}};
  for (const auto& [name, array] : archive.arrays) {
    std::ostringstream out;
    core::write_npy(out, array);
    files[name] = bytes.put(out.str());
  }
  return files;
}

cv::Mat to_bytes(const cv::Mat& levels, double factor = 1) {
  cv::Mat bytes;
  levels.convertTo(bytes, CV_8U, factor);
  return bytes;
}

Json put_look(const pipeline::ClipModel& model, PageBytes& bytes) {
  const auto look = sketch::apply_sharpening(pipeline::render_options(model.motion, model.background, {}),
                                             model.sharpening);
  Json json = {{"channels", look.channels},
               {"empty_level", look.empty_level},
               {"blur_share", look.blur_share},
               {"contrast_gain", look.contrast_gain}};
  if (const auto& range = look.background.level_range; !range.empty())
    json["range"] = {{"columns", range.low.cols},
                     {"rows", range.low.rows},
                     {"channels", range.low.channels()},
                     {"low", bytes.put(range.low)},
                     {"high", bytes.put(range.high)}};
  const auto still = sketch::expand_background(look.background, look.size, look.channels);
  if (still.empty()) return json;
  const cv::Mat none = cv::Mat::zeros(look.size, CV_8U);
  json["still"] = {{"levels", bytes.put(to_bytes(still.levels))},
                   {"still", bytes.put(still.still)},
                   {"fixed", bytes.put(still.fixed.empty() ? none : still.fixed)},
                   {"share", bytes.put(still.share.empty() ? none : to_bytes(still.share, 255))}};
  return json;
}

// Returns the name of the run whose folder "model" this is, otherwise the folder's own name.
std::string run_title(const std::string& folder) {
  const auto path = std::filesystem::path(folder).lexically_normal();
  const auto model = path.has_filename() ? path : path.parent_path();
  return page_title(model.filename() == "model" && model.has_parent_path() ? model.parent_path().string()
                                                                           : folder);
}

void check(const MotionPageInput& input) {
  if (motion_page_program().empty())
    throw core::InputError(
        "this emberfold was built without the simulator for pages; install its compiler (scripts/deps wasm) "
        "and build again with -DEMBERFOLD_WASM=ON");
  const auto& motion = input.model->motion;
  if (const auto why = pipeline::why_undrawable(motion); !why.empty()) throw core::InputError(why);
  if (static_cast<long long>(motion.width) * motion.height > kMotionPagePixels)
    throw core::InputError("the model's frames are " + core::size_text(motion.width, motion.height) +
                           "; a page takes at most " + std::to_string(kMotionPagePixels) + " pixels");
}

}  // namespace

std::string make_motion_page(const MotionPageInput& input) {
  check(input);
  const auto& motion = input.model->motion;
  const std::string title = run_title(input.folder);
  PageBytes bytes;
  Json data = {{"title", title},          {"model", shown_path(input.folder)}, {"version", input.version},
               {"width", motion.width},   {"height", motion.height},           {"fps", motion.fps},
               {"frames", motion.frames}, {"files", put_model(motion, bytes)}};
  data["look"] = put_look(*input.model, bytes);
  return fill_in(kMotionPageTemplate, {{"title", escape_html(title)},
                                       {"style", std::string(kPageStyle) + std::string(kMotionPageStyle)},
                                       {"data", embed_json(data)},
                                       {"program", packed_bytes(motion_page_program())},
                                       {"files", packed_bytes(bytes.all)},
                                       {"script", kMotionPageScript}});
}

}  // namespace emberfold::apps
