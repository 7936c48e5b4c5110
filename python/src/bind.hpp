// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

// Binds each room to Python; called once, in this order.
namespace emberfold::python {

void bind_core(pybind11::module_& module);
void bind_clip(pybind11::module_& module);
void bind_graph(pybind11::module_& module);
void bind_events(pybind11::module_& module);
void bind_sketch(pybind11::module_& module);
void bind_mcmc(pybind11::module_& module);
void bind_dytex(pybind11::module_& module);
void bind_textures(pybind11::module_& module);
void bind_quilt(pybind11::module_& module);
void bind_model(pybind11::module_& module);
void bind_pipeline(pybind11::module_& module);
void bind_compare(pybind11::module_& module);

}  // namespace emberfold::python
