// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <pybind11/eigen.h>

#include "dytex/measures/autocorrelation.hpp"
#include "dytex/measures/optical_flow.hpp"
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

namespace {

Eigen::VectorXd autocorrelation(const ClipData& clip, int lags, const py::object& progress) {
  return call(progress, [&](const core::Context& context) {
    const auto source = clip.open();
    const auto& info = source->info();
    dytex::Autocorrelation memory({info.width, info.height}, lags);
    for (cv::Mat frame = source->next(); !frame.empty(); frame = source->next()) {
      context.check();
      memory.add(core::luma(frame, info));
    }
    return memory.values();
  });
}

void bind_frame_measures(py::module_& module) {
  module.def(
      "crease_sharpness",
      [](const py::array& luma) {
        const auto found = dytex::crease_sharpness(to_levels(luma, "luma"));
        return py::dict(py::arg("gradient") = found.gradient, py::arg("sharpness") = found.sharpness,
                        py::arg("points") = found.points);
      },
      py::arg("luma"), doc("dytex::crease_sharpness"));
  module.def(
      "optical_flow",
      [](const py::array& luma, const py::array& next, double most_vectors) {
        const cv::Mat from = to_levels(luma, "luma"), to = to_levels(next, "next");
        return to_array(call(
            py::none(), [&](const core::Context&) { return dytex::optical_flow(from, to, most_vectors); }));
      },
      py::arg("luma"), py::arg("next"), py::arg("most_vectors") = 1 << 16, doc("dytex::optical_flow"));
  module.def(
      "log_spectral_distance",
      [](const Eigen::VectorXd& p, const Eigen::VectorXd& q, double floor) {
        return dytex::log_spectral_distance(p, q, floor);
      },
      py::arg("p"), py::arg("q"), py::arg("floor") = dytex::kRounding, doc("dytex::log_spectral_distance"));
  module.def("autocorrelation", autocorrelation, py::arg("clip"), py::arg("lags"),
             py::arg("progress") = py::none(), doc("dytex::Autocorrelation"));
}

}  // namespace

void bind_measures(py::module_& module) {
  bind_frame_measures(module);
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
