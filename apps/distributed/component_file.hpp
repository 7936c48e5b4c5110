// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include <Eigen/Core>

namespace emberfold::apps {

/// A C.npy that several processes write, each its rows. Functions throw core::IoError.
class ComponentFile {
 public:
  /// `values`: m, rows of C.
  ComponentFile(std::filesystem::path path, std::size_t values) : path_(std::move(path)), values_(values) {}

  /// Makes the file of n columns, and takes its room on the disk; one process does, before any row.
  void begin(Eigen::Index n) const;
  /// Writes the rows from `first` on.
  void put(std::size_t first, const Eigen::MatrixXf& rows) const;
  /// Reads the first `count` columns of n.
  [[nodiscard]] Eigen::MatrixXf first_columns(Eigen::Index count, Eigen::Index n) const;

 private:
  [[nodiscard]] std::string header(Eigen::Index n) const;
  std::filesystem::path path_;
  std::size_t values_;
};

}  // namespace emberfold::apps
