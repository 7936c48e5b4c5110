// SPDX-License-Identifier: Apache-2.0
#include "python/src/docs.hpp"

#include <map>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace emberfold::python {

namespace {

namespace py = pybind11;

std::map<std::string, std::string> read_texts() {
  try {
    return py::module_::import("emberfold._docs").attr("TEXTS").cast<std::map<std::string, std::string>>();
  } catch (py::error_already_set& error) {
    // The module works without them: the build reads the stubs off it before the package is whole.
    if (!error.matches(PyExc_ImportError)) throw;
    return {};
  }
}

}  // namespace

const char* doc(const std::string& name) {
  static const auto* const texts = new std::map<std::string, std::string>(read_texts());
  const auto found = texts->find(name);
  return found == texts->end() ? "" : found->second.c_str();
}

}  // namespace emberfold::python
