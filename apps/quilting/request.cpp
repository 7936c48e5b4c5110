// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/request.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

bool parse_whole(std::string_view text, int& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc{} && stop == text.data() + text.size();
}

// Rewrites "QuiltOptions.overlap is …" with the option's name on the command line.
std::string as_option(const std::string& message) {
  std::string name = message.substr(0, message.find(' '));
  const std::string rest = message.substr(name.size());
  if (!name.starts_with("QuiltOptions.")) return message;
  name = name.substr(std::string("QuiltOptions.").size());
  return (name == "size" || name == "block" || name == "tileable" ? "--" : "quilt.") + name + rest;
}

}  // namespace

cv::Size parse_size(const std::string& option, const std::string& text) {
  cv::Size size;
  const auto cross = text.find('x');
  const std::string_view view = text;
  const bool right = cross == std::string::npos ? parse_whole(view, size.width)
                                                : parse_whole(view.substr(0, cross), size.width) &&
                                                      parse_whole(view.substr(cross + 1), size.height);
  if (!right)
    throw Misuse(option + " is '" + text + "'; give a width and a height, as 640x480, or one number");
  if (cross == std::string::npos) size.height = size.width;
  return size;
}

void complete_request(QuiltRequest& request, cv::Size source) {
  auto& quilt = request.quilt;
  if (!request.own_size)
    quilt.size =
        request.surface.empty() ? cv::Size(2 * source.width, 2 * source.height) : cv::Size(1024, 1024);
  if (!request.own_block) {
    const int side = std::clamp(std::min(source.width, source.height) / 2, 2, 64);
    quilt.block = {side, side};
  }
  if (!request.own_overlap) quilt.overlap = std::max(1, std::min(quilt.block.width, quilt.block.height) / 4);
  quilt.apart = std::min(quilt.block.width, quilt.block.height) / 2;
  try {
    quilt.validate();
  } catch (const core::InputError& error) {
    throw Misuse(as_option(error.what()));
  }
  if (request.apply.empty() && (quilt.block.width > source.width || quilt.block.height > source.height))
    throw Misuse("--block is " + core::size_text(quilt.block) + ", but " + request.clips.front() +
                 " has only " + core::size_text(source) + " pixels");
}

namespace {

void check_surface_request(const QuiltRequest& request) {
  if (request.surface.empty()) return;
  if (!request.apply.empty() || request.quilt.tileable || !request.guide.empty() || request.seams != "still")
    throw Misuse(
        "quilt.surface seeks a map of its own, with seams that stand still: --apply, --tileable, --guide and "
        "quilt.seams=moving have nothing to do there");
}

}  // namespace

void check_request(const QuiltRequest& request) {
  const auto refuse = [](const std::string& option, const std::string& value, const std::string& allowed) {
    throw Misuse(option + " is " + value + "; allowed is " + allowed);
  };
  if (request.masks.size() > request.clips.size())
    throw Misuse("there are " + std::to_string(request.masks.size()) + " masks for " +
                 std::to_string(request.clips.size()) + (request.clips.size() == 1 ? " clip" : " clips"));
  if (request.flatten != 0 && !(request.flatten >= 1 && request.flatten <= 4096))
    refuse("quilt.flatten", std::to_string(request.flatten), "1 to 4096 pixels, or 0 for not at all");
  if (request.frames && (*request.frames < 1 || *request.frames > 1'000'000))
    refuse("--frames", std::to_string(*request.frames), "1 to 1000000");
  if (request.frame && (*request.frame < 0 || *request.frame > 1'000'000))
    refuse("--frame", std::to_string(*request.frame), "0 to 1000000");
  if (request.memory < 0 || request.memory > 1'000'000)
    refuse("quilt.memory", std::to_string(request.memory), "0 to 1000000 MB");
  check_surface_request(request);
  if (!request.apply.empty() && (request.own_size || !request.guide.empty() || !request.masks.empty()))
    throw Misuse("--apply uses the map unchanged: --size, --guide and --mask do not apply to it");
  const std::string extension = std::filesystem::path(request.output).extension().string();
  if (!extension.empty() && extension != ".mp4" && extension != ".avi" && extension != ".png")
    throw Misuse("-o is " + request.output +
                 "; give a name in .mp4, .avi or (for one frame) .png, or that of a folder");
  if (!extension.empty() && !request.format.empty())
    throw Misuse("quilt.format is for a folder; the clip " + request.output + " tells its own");
  dytex::QuiltOptions sizes_aside = request.quilt;
  sizes_aside.tileable = false;
  if (!request.own_block) sizes_aside.block = {64, 64};
  if (!request.own_overlap) sizes_aside.overlap = 1;
  try {
    sizes_aside.validate();
  } catch (const core::InputError& error) {
    throw Misuse(as_option(error.what()));
  }
}

Json request_json(const QuiltRequest& request) {
  const auto& quilt = request.quilt;
  const auto& control = request.control;
  Json out = Json::object();
  if (request.apply.empty())
    out["quilt"] = {{"size", {quilt.size.width, quilt.size.height}},
                    {"block", {quilt.block.width, quilt.block.height}},
                    {"overlap", quilt.overlap},
                    {"guide", request.guide},
                    {"masks", request.masks},
                    {"tileable", quilt.tileable},
                    {"seams", request.seams}};
  else
    out["apply"] = request.apply;
  if (!request.surface.empty()) out["quilt"]["surface"] = request.surface;
  out["flatten"] = request.flatten;
  out["control"] = {
      {"rate", control.rate}, {"offset", control.offset}, {"jitter", control.jitter}, {"ends", control.ends}};
  return out;
}

}  // namespace emberfold::apps
