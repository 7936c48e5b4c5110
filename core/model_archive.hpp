// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "core/npy.hpp"

namespace emberfold::core {

/// A learned model as it lies in a folder: the text of model.json, and the arrays beside it by their names
/// without ".npy". Rooms turn their models into archives and back; who opens the folder is not their matter.
struct ModelArchive {
  std::string text;
  std::map<std::string, NpyArray> arrays;
};

/// The same of a model whose arrays lie elsewhere: written without a copy.
struct ModelView {
  std::string text;
  std::map<std::string, NpyView> arrays;
};

}  // namespace emberfold::core
