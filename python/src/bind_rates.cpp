// SPDX-License-Identifier: Apache-2.0
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/math/event_rates.hpp"
#include "core/math/group_rates.hpp"
#include "python/src/bind.hpp"
#include "python/src/docs.hpp"

// Rates of events and of groups of clips, with their intervals.
namespace emberfold::python {

namespace py = pybind11;

namespace {

using Counted = std::vector<std::pair<double, double>>;

py::tuple interval(const core::Interval& found) {
  return py::make_tuple(found.mean, found.low, found.high);
}

std::vector<core::CountedClip> clips_of(const Counted& given) {
  std::vector<core::CountedClip> clips;
  for (const auto& [count, exposure] : given) clips.push_back({count, exposure});
  return clips;
}

}  // namespace

void bind_rates(py::module_& module) {
  module.def(
      "event_rate",
      [](double count, double exposure, double level) {
        return interval(core::event_rate(count, exposure, level));
      },
      py::arg("count"), py::arg("exposure"), py::arg("level") = 0.9, doc("core::event_rate"));
  module.def(
      "compare_rates",
      [](double count_a, double exposure_a, double count_b, double exposure_b, double level) {
        const auto found = core::compare_rates(count_a, exposure_a, count_b, exposure_b, level);
        return py::dict(py::arg("ratio") = interval(found.ratio), py::arg("p") = found.p);
      },
      py::arg("count_a"), py::arg("exposure_a"), py::arg("count_b"), py::arg("exposure_b"),
      py::arg("level") = 0.9, doc("core::compare_rates"));
  module.def(
      "group_rate",
      [](const Counted& clips, double level) {
        const auto found = core::group_rate(clips_of(clips), level);
        return py::dict(py::arg("rate") = interval(found.rate), py::arg("dispersion") = found.dispersion);
      },
      py::arg("clips"), py::arg("level") = 0.9, doc("core::group_rate"));
  module.def(
      "compare_groups",
      [](const Counted& first, const Counted& second, double level, std::uint64_t seed) {
        const auto found = core::compare_groups(clips_of(first), clips_of(second), level, seed);
        return py::dict(py::arg("ratio") = interval(found.ratio), py::arg("dispersion") = found.dispersion,
                        py::arg("p") = found.p, py::arg("permuted") = found.permuted);
      },
      py::arg("first"), py::arg("second"), py::arg("level") = 0.9, py::arg("seed") = 1,
      doc("core::compare_groups"));
}

}  // namespace emberfold::python
