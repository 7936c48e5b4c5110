// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include <Eigen/Core>

namespace emberfold::apps {

/// A C.npy to which several processes write their rows. Functions throw core::IoError.
class ComponentFile {
 public:
  /// `values`: m, rows of C.
  ComponentFile(std::filesystem::path path, std::size_t values) : path_(std::move(path)), values_(values) {}

  /// Creates the file of n columns and allocates its disk space; called by one process before any row is
  /// written.
  void begin(Eigen::Index n) const;
  /// Writes rows, beginning with row `first`.
  void put(std::size_t first, const Eigen::MatrixXf& rows) const;
  /// Reads the first `count` columns of n.
  [[nodiscard]] Eigen::MatrixXf first_columns(Eigen::Index count, Eigen::Index n) const;

 private:
  [[nodiscard]] std::string header(Eigen::Index n) const;
  std::filesystem::path path_;
  std::size_t values_;
};

}  // namespace emberfold::apps
