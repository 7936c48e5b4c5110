// SPDX-License-Identifier: Apache-2.0
#include "python/src/bind.hpp"

PYBIND11_MODULE(_native, module) {
  module.doc() = "The libraries of emberfold; use the package emberfold, which is made of them.";
  module.attr("__version__") = EMBERFOLD_VERSION;
  emberfold::python::bind_core(module);
  emberfold::python::bind_clip(module);
  emberfold::python::bind_graph(module);
  emberfold::python::bind_events(module);
  emberfold::python::bind_sketch(module);
  emberfold::python::bind_mcmc(module);
  emberfold::python::bind_dytex(module);
  emberfold::python::bind_textures(module);
  emberfold::python::bind_quilt(module);
  emberfold::python::bind_model(module);
  emberfold::python::bind_pipeline(module);
  emberfold::python::bind_compare(module);
}
