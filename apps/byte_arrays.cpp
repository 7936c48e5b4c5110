// SPDX-License-Identifier: Apache-2.0
#include "apps/byte_arrays.hpp"

#include <variant>

#include "core/error.hpp"

namespace emberfold::apps {

core::NpyArray byte_array(const cv::Mat& values) {
  const cv::Mat row = values.reshape(1, 1);
  return {{static_cast<std::size_t>(values.rows), static_cast<std::size_t>(values.cols),
           static_cast<std::size_t>(values.channels())},
          false,
          std::vector<std::uint8_t>(row.begin<std::uint8_t>(), row.end<std::uint8_t>())};
}

const std::vector<std::uint8_t>& byte_array(const core::ModelArchive& archive, const std::string& name,
                                            cv::Size size, std::size_t channels) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) throw core::IoError("motion model: " + name + ".npy is missing");
  const auto* const values = std::get_if<std::vector<std::uint8_t>>(&found->second.data);
  const std::vector shape{static_cast<std::size_t>(size.height), static_cast<std::size_t>(size.width),
                          channels};
  if (!values || found->second.fortran_order || found->second.shape != shape)
    throw core::IoError("motion model: " + name + ".npy must be uint8, " + std::to_string(shape[0]) + " x " +
                        std::to_string(shape[1]) + " x " + std::to_string(channels));
  return *values;
}

}  // namespace emberfold::apps
