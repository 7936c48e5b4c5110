// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "core/npy.hpp"

namespace emberfold::core {

/// A learned model as files of a folder, held in memory.
/// Libraries convert their models to archives and back; core/io reads and writes the folder.
struct ModelArchive {
  std::string text;                        ///< content of model.json
  std::map<std::string, NpyArray> arrays;  ///< by file name without ".npy"
};

/// A model to be written without copying its arrays, which it refers to.
struct ModelView {
  std::string text;
  std::map<std::string, NpyView> arrays;
};

}  // namespace emberfold::core
