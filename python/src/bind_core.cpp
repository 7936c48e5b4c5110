// SPDX-License-Identifier: Apache-2.0
#include "core/context.hpp"
#include "core/error.hpp"
#include "python/src/bind.hpp"
#include "python/src/docs.hpp"

namespace emberfold::python {

namespace py = pybind11;

void bind_core(py::module_& module) {
  // Each is also what Python calls such an error, so that code that knows nothing of emberfold catches it.
  const auto add = [](const py::object& error, const char* name) { error.attr("__doc__") = doc(name); };
  add(py::register_exception<core::InputError>(module, "InputError", PyExc_ValueError), "core::InputError");
  add(py::register_exception<core::IoError>(module, "IoError", PyExc_OSError), "core::IoError");
  add(py::register_exception<core::NumericalError>(module, "NumericalError", PyExc_ArithmeticError),
      "core::NumericalError");
  add(py::register_exception<core::Cancelled>(module, "Cancelled", PyExc_RuntimeError), "core::Cancelled");
}

}  // namespace emberfold::python
