// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "core/npy.hpp"

namespace emberfold::core {

/// Holds a learned model as its folder does: the text of model.json, and by name the arrays beside it (without
/// ".npy") and the models in folders below it. Rooms turn their models into archives and back, core/io writes
/// and reads the folder.
struct ModelArchive {
  std::string text;
  std::map<std::string, NpyArray> arrays;
  std::map<std::string, ModelArchive> parts = {};
};

/// Refers to a model whose arrays lie elsewhere, to be written without a copy.
struct ModelView {
  std::string text;
  std::map<std::string, NpyView> arrays;
};

}  // namespace emberfold::core
