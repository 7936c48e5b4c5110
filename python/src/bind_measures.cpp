// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <pybind11/eigen.h>

#include "dytex/measures/psnr.hpp"
#include "dytex/measures/sharpness_si_ti.hpp"
#include "dytex/measures/spectra.hpp"
#include "dytex/measures/ssim.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/docs.hpp"

namespace emberfold::python {

void bind_measures(py::module_& module) {
  module.def(
      "structural_similarity",
      [](const py::array& a, const py::array& b) {
        return dytex::structural_similarity(to_levels(a, "a"), to_levels(b, "b"));
      },
      py::arg("a"), py::arg("b"), doc("dytex::structural_similarity"));
  module.def(
      "mean_square_error",
      [](const py::array& a, const py::array& b) {
        return dytex::mean_square_error(to_levels(a, "a"), to_levels(b, "b"));
      },
      py::arg("a"), py::arg("b"), doc("dytex::mean_square_error"));
  module.def("psnr", &dytex::psnr, py::arg("mean_square_error"), doc("dytex::psnr"));
  module.def(
      "spatial_information",
      [](const py::array& luma) { return dytex::spatial_information(to_levels(luma, "luma")); },
      py::arg("luma"), doc("dytex::spatial_information"));
  module.def(
      "temporal_information",
      [](const py::array& luma, const py::array& before) {
        return dytex::temporal_information(to_levels(luma, "luma"), to_levels(before, "before"));
      },
      py::arg("luma"), py::arg("before"), doc("dytex::temporal_information"));
  module.def(
      "temporal_spectrum",
      [](const ClipData& clip, int segment, const py::object& progress) {
        return call(progress, [&](const core::Context& context) {
          return dytex::temporal_spectrum(*clip.open(), segment, context);
        });
      },
      py::arg("clip"), py::arg("segment"), py::arg("progress") = py::none(), doc("dytex::temporal_spectrum"));
  module.def(
      "radial_spectrum",
      [](const ClipData& clip, int rings, const py::object& progress) {
        return call(progress, [&](const core::Context& context) {
          return dytex::radial_spectrum(*clip.open(), rings, context);
        });
      },
      py::arg("clip"), py::arg("rings"), py::arg("progress") = py::none(), doc("dytex::radial_spectrum"));
}

}  // namespace emberfold::python
