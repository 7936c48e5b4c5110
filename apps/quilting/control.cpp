// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/cli/command.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/npy.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::apps {

namespace {

constexpr double kWhiteRate = 1;     // speed of time where an image is white
constexpr double kWhiteOffset = 30;  // frames: offset there

std::optional<double> parse_one_number(const std::string& text) {
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  if (text.empty() || stop != text.c_str() + text.size()) return std::nullopt;
  return value;
}

void check_size(const cv::Mat& field, cv::Size size, const std::string& name) {
  if (field.size() != size)
    throw core::InputError(name + " has " + core::size_text(field.size()) + " pixels, the output " +
                           core::size_text(size));
}

// Splits an array into its planes.
std::vector<cv::Mat> array_planes(const std::string& name) {
  auto stream = io::open_file(name);
  core::NpyArray array;
  try {
    array = core::read_npy(stream);
  } catch (const core::IoError& error) {
    throw core::IoError(name + ": " + error.what());
  }
  const auto& shape = array.shape;
  const bool two = shape.size() == 3 && shape[2] == 2;
  if ((shape.size() != 2 && !two) || shape[0] < 1 || shape[1] < 1 || shape[0] > 65536 || shape[1] > 65536 ||
      array.fortran_order)
    throw core::IoError(name +
                        ": a control map is an array of height x width, or height x width x 2 with rates "
                        "and offsets, in C order");
  const std::size_t planes = two ? 2 : 1, width = shape[1];
  std::vector<cv::Mat> out;
  for (std::size_t p = 0; p < planes; ++p)
    out.emplace_back(static_cast<int>(shape[0]), static_cast<int>(width), CV_32F);
  std::visit(
      [&]<class Value>(const std::vector<Value>& values) {
        for (std::size_t i = 0; i < values.size(); ++i) {
          float& to = out[i % planes].ptr<float>(static_cast<int>(i / planes / width))[i / planes % width];
          if constexpr (std::is_same_v<Value, core::Half>)
            to = core::to_float(values[i]);
          else
            to = static_cast<float>(values[i]);
        }
      },
      array.data);
  return out;
}

cv::Mat grey_image(const std::string& name) {
  cv::Mat grey, pixels = io::read_image(name).pixels;
  if (pixels.channels() == 3) cv::cvtColor(pixels, pixels, cv::COLOR_BGR2GRAY);
  pixels.convertTo(grey, CV_32F);
  return grey;
}

// Returns a ramp 0…1 over the output in a direction.
cv::Mat gradient_field(const std::string& to, cv::Size size, const std::string& option) {
  const bool across = to == "right" || to == "left", back = to == "left" || to == "up";
  if (!across && to != "down" && to != "up")
    throw Misuse(option + " is gradient:" + to + "; allowed is gradient:right, left, down or up");
  cv::Mat field(size, CV_32F);
  const double length = std::max(1, (across ? size.width : size.height) - 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double share = (across ? x : y) / length;
      field.at<float>(y, x) = static_cast<float>(back ? 1 - share : share);
    }
  return field;
}

// Maps the least value to 1 and the largest to 0; all 1 for a constant picture.
cv::Mat nearness(const cv::Mat& far) {
  double least = 0, most = 0;
  cv::minMaxLoc(far, &least, &most);
  if (least == most) return {far.size(), CV_32F, cv::Scalar(1)};
  return (most - far) / (most - least);
}

cv::Mat distance_nearness(const std::string& name) {
  const cv::Mat mask = grey_image(name) > 0;
  if (cv::countNonZero(mask) == 0)
    throw core::InputError(name + ": this mask is black everywhere, so that nothing has a distance to it");
  cv::Mat distance;
  cv::distanceTransform(~mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return nearness(distance);
}

struct Named {
  std::string option, text;
  double white;  // what an image means where it is white; black is 0
};

// Returns the field first, then the other planes of an array.
std::vector<cv::Mat> fields_of(const Named& named, cv::Size size) {
  if (named.text.empty()) return {};
  if (const auto value = parse_one_number(named.text)) return {cv::Mat(size, CV_32F, cv::Scalar(*value))};
  if (named.text.ends_with(".npy")) {
    auto planes = array_planes(named.text);
    for (const auto& plane : planes) check_size(plane, size, named.text);
    return planes;
  }
  const auto colon = named.text.find(':');
  const std::string kind = named.text.substr(0, colon == std::string::npos ? 0 : colon);
  const std::string rest = named.text.substr(colon == std::string::npos ? 0 : colon + 1);
  cv::Mat shares;
  if (kind == "gradient") {
    shares = gradient_field(rest, size, named.option);
  } else if (kind == "depth") {
    shares = nearness(grey_image(rest));
  } else if (kind == "distance") {
    shares = distance_nearness(rest);
  } else {
    const cv::Mat pixels = io::read_image(named.text).pixels;
    shares = grey_image(named.text) / (pixels.depth() == CV_16U ? 65535.0 : 255.0);
  }
  check_size(shares, size, named.text);
  return {cv::Mat(named.white * shares)};
}

}  // namespace

dytex::TimeControl make_control(const ControlRequest& request, cv::Size size, cv::Size block,
                                std::uint64_t seed) {
  dytex::TimeControl control;
  control.ends = request.ends == "loop"        ? dytex::ClipEnds::loop
                 : request.ends == "ping-pong" ? dytex::ClipEnds::ping_pong
                                               : dytex::ClipEnds::clamp;
  const auto rates = fields_of({"--control", request.rate, kWhiteRate}, size);
  const auto offsets = fields_of({"--offset", request.offset, kWhiteOffset}, size);
  if (!rates.empty()) control.rate = rates.front();
  if (rates.size() == 2) {
    if (!offsets.empty())
      throw Misuse("--control " + request.rate + " holds offsets, so that control.offset cannot be");
    control.offset = rates.back();
  }
  if (offsets.size() == 2)
    throw core::InputError(request.offset + ": offsets are an array of height x width");
  if (!offsets.empty()) control.offset = offsets.front();
  if (!(request.jitter >= 0 && request.jitter <= 10000))
    throw Misuse("control.jitter is " + std::to_string(request.jitter) + "; allowed is 0 to 10000 frames");
  if (request.jitter > 0) {
    const cv::Mat jitter = dytex::time_jitter(size, block, request.jitter, seed);
    control.offset = control.offset.empty() ? jitter : cv::Mat(control.offset + jitter);
  }
  try {
    control.validate(size);
  } catch (const core::InputError& error) {
    std::string message = error.what();
    for (const auto& [field, option, text] :
         {std::tuple("TimeControl.rate", "--control", request.rate),
          std::tuple("TimeControl.offset", rates.size() == 2 ? "--control (offset)" : "--offset",
                     rates.size() == 2 ? request.rate : request.offset)})
      if (message.starts_with(field))
        message.replace(0, std::string_view(field).size(), std::string(option).append(" ").append(text));
    throw core::InputError(message);
  }
  return control;
}

}  // namespace emberfold::apps
