// SPDX-License-Identifier: Apache-2.0
#include "core/model_arrays.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "core/error.hpp"

namespace emberfold::core {

namespace {

template <class T>
core::NpyArray array_of(const cv::Mat& values) {
  const cv::Mat row = values.reshape(1, 1);
  return {{static_cast<std::size_t>(values.rows), static_cast<std::size_t>(values.cols),
           static_cast<std::size_t>(values.channels())},
          false,
          std::vector<T>(row.begin<T>(), row.end<T>())};
}

std::string text_of(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const auto length : shape) text += (text.empty() ? "" : " x ") + std::to_string(length);
  return text;
}

template <class T>
cv::Mat values_of(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels) {
  const auto refuse = [&](const std::string& why) {
    throw core::IoError("motion model: " + name + ".npy " + why);
  };
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse("is missing");
  const auto& array = found->second;
  const auto* const values = std::get_if<std::vector<T>>(&array.data);
  const std::vector shape{static_cast<std::size_t>(size.height), static_cast<std::size_t>(size.width),
                          static_cast<std::size_t>(channels)};
  auto has = array.shape;
  if (channels == 1 && has.size() == 2) has.push_back(1);
  if (!values || array.fortran_order || has != shape)
    refuse("is " + text_of(array.shape) + "; expected " +
           (std::is_same_v<T, float> ? "float32, " : "uint8, ") + text_of(shape));
  if constexpr (std::is_same_v<T, float>)
    if (!std::ranges::all_of(*values, [](float value) { return std::abs(value) <= 1e6F; }))
      refuse("holds a number that is not finite or out of range");
  cv::Mat read(size, CV_MAKETYPE(cv::DataType<T>::depth, channels));
  std::ranges::copy(*values, read.ptr<T>());
  return read;
}

}  // namespace

core::NpyArray byte_array(const cv::Mat& values) {
  return array_of<std::uint8_t>(values);
}

core::NpyArray float_array(const cv::Mat& values) {
  return array_of<float>(values);
}

cv::Mat read_bytes(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels) {
  return values_of<std::uint8_t>(archive, name, size, channels);
}

cv::Mat read_floats(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels) {
  return values_of<float>(archive, name, size, channels);
}

int channels_of(const core::ModelArchive& archive, const std::string& name) {
  const auto found = archive.arrays.find(name);
  const bool grey =
      found != archive.arrays.end() && found->second.shape.size() == 3 && found->second.shape.back() == 1;
  return grey ? 1 : 3;
}

}  // namespace emberfold::core
