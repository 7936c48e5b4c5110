// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/model/motion_model.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using mcmc::MotionModel;
using mcmc::OperatorRates;

/// A view of numbers that may be written to; `owner` holds them.
py::array_t<double> numbers(double* data, std::vector<py::ssize_t> shape, const py::handle& owner) {
  return py::array_t<double>(std::move(shape), data, owner);
}

/// Copies an array over numbers; the same ones, where it is a view of them.
void assign(double* data, std::vector<py::ssize_t> shape, const py::array_t<double>& given,
            const std::string& name) {
  const auto whole = py::array_t<double, py::array::c_style>::ensure(given);
  bool fits = given.ndim() == static_cast<py::ssize_t>(shape.size());
  std::size_t count = 1;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    fits = fits && given.shape(static_cast<py::ssize_t>(i)) == shape[i];
    count *= static_cast<std::size_t>(shape[i]);
  }
  if (!fits || !whole)
    throw py::value_error(name + " has the shape " + py::str(given.attr("shape")).cast<std::string>() +
                          "; allowed is " + py::str(py::cast(shape)).cast<std::string>());
  std::memmove(data, whole.data(), count * sizeof(double));
}

using RatesClass = py::class_<OperatorRates>;

void number(RatesClass& rates, const char* name, double OperatorRates::*member) {
  rates.def_property(
      name, [member](const OperatorRates& r) { return r.*member; },
      [member, name](OperatorRates& r, double value) {
        if (!(std::isfinite(value) && value >= 0))
          throw py::value_error("rates." + std::string(name) + " is " + std::to_string(value) +
                                "; allowed is a number from 0 on");
        r.*member = value;
      },
      doc("mcmc::OperatorRates::" + std::string(name)));
}

void map(RatesClass& rates, const char* name, mcmc::CellMap OperatorRates::*member) {
  const auto shape = [](const mcmc::CellMap& map) -> std::vector<py::ssize_t> {
    return {map.rows, map.columns};
  };
  rates.def_property(
      name,
      [member, shape](const py::object& self) {
        auto& map = self.cast<OperatorRates&>().*member;
        return numbers(map.values.data(), shape(map), self);
      },
      [member, shape, name](OperatorRates& r, const py::array_t<double>& given) {
        auto& map = r.*member;
        assign(map.values.data(), shape(map), given, "rates." + std::string(name));
      },
      doc("mcmc::OperatorRates::" + std::string(name)));
}

void by_size(RatesClass& rates, const char* name,
             std::array<double, mcmc::kSizeClasses> OperatorRates::*member) {
  constexpr auto kCount = static_cast<py::ssize_t>(mcmc::kSizeClasses);
  rates.def_property(
      name,
      [member](const py::object& self) {
        return numbers((self.cast<OperatorRates&>().*member).data(), {kCount}, self);
      },
      [member, name](OperatorRates& r, const py::array_t<double>& given) {
        assign((r.*member).data(), {kCount}, given, "rates." + std::string(name));
      },
      doc("mcmc::OperatorRates::" + std::string(name)));
}

using MapState = std::tuple<double, int, int, std::vector<double>>;

MapState map_state(const mcmc::CellMap& map) {
  return {map.cell, map.columns, map.rows, map.values};
}
mcmc::CellMap map_from(const py::handle& state) {
  auto [cell, columns, rows, values] = state.cast<MapState>();
  return {cell, columns, rows, std::move(values)};
}

py::tuple rates_state(const OperatorRates& r) {
  const auto& m = r.modifiers;
  return py::make_tuple(map_state(r.birth), r.birth_by_size, map_state(r.death), r.death_by_size,
                        map_state(r.separation),
                        std::array{r.split, r.merge, r.connect, r.disconnect, r.reach, r.split_gap,
                                   r.disconnect_gap, r.refractory_period},
                        py::make_tuple(m.death, m.separation, m.unification, m.bridging, m.turning, m.pace));
}

OperatorRates rates_from(const py::tuple& state) {
  OperatorRates r;
  r.birth = map_from(state[0]), r.death = map_from(state[2]), r.separation = map_from(state[4]);
  r.birth_by_size = state[1].cast<decltype(r.birth_by_size)>();
  r.death_by_size = state[3].cast<decltype(r.death_by_size)>();
  const auto numbers = state[5].cast<std::array<double, 8>>();
  r.split = numbers[0], r.merge = numbers[1], r.connect = numbers[2], r.disconnect = numbers[3];
  r.reach = numbers[4], r.split_gap = numbers[5], r.disconnect_gap = numbers[6];
  r.refractory_period = numbers[7];
  const py::tuple factors = state[6];
  auto& m = r.modifiers;
  m.death = factors[0].cast<decltype(m.death)>(), m.separation = factors[1].cast<decltype(m.separation)>();
  m.unification = factors[2].cast<decltype(m.unification)>();
  m.bridging = factors[3].cast<decltype(m.bridging)>(), m.turning = factors[4].cast<decltype(m.turning)>();
  m.pace = factors[5].cast<double>();
  return r;
}

void bind_operator_rates(py::module_& module) {
  RatesClass rates(module, "OperatorRates", doc("mcmc::OperatorRates"));
  number(rates, "split", &OperatorRates::split);
  number(rates, "merge", &OperatorRates::merge);
  number(rates, "connect", &OperatorRates::connect);
  number(rates, "disconnect", &OperatorRates::disconnect);
  number(rates, "reach", &OperatorRates::reach);
  number(rates, "split_gap", &OperatorRates::split_gap);
  number(rates, "disconnect_gap", &OperatorRates::disconnect_gap);
  number(rates, "refractory_period", &OperatorRates::refractory_period);
  map(rates, "birth", &OperatorRates::birth);
  map(rates, "death", &OperatorRates::death);
  map(rates, "separation", &OperatorRates::separation);
  by_size(rates, "birth_by_size", &OperatorRates::birth_by_size);
  by_size(rates, "death_by_size", &OperatorRates::death_by_size);
  rates.attr("__hash__") = py::none();
  rates.def("__copy__", [](const OperatorRates& r) { return r; })
      .def("__deepcopy__", [](const OperatorRates& r, const py::dict&) { return r; })
      .def("__eq__",
           [](const OperatorRates& a, const py::object& b) {
             return py::isinstance<OperatorRates>(b) && a == b.cast<const OperatorRates&>();
           })
      .def(py::pickle([](const OperatorRates& r) { return rates_state(r); },
                      [](const py::tuple& state) { return rates_from(state); }));
  rates.def("__repr__", [](const OperatorRates& r) {
    return "OperatorRates(split=" + std::to_string(r.split) + ", merge=" + std::to_string(r.merge) +
           ", connect=" + std::to_string(r.connect) + ", disconnect=" + std::to_string(r.disconnect) + ")";
  });
}

void bind_autoregression(py::module_& module) {
  using mcmc::Autoregression;
  OptionsClass<Autoregression>(module, "Autoregression", "mcmc::Autoregression")
      .field("a1", &Autoregression::a1)
      .field("a2", &Autoregression::a2)
      .field("coupling", &Autoregression::coupling)
      .field("noise", &Autoregression::noise)
      .field("range", &Autoregression::range)
      .field("measurement", &Autoregression::measurement)
      .finish();
}

}  // namespace

void bind_mcmc(py::module_& module) {
  bind_autoregression(module);
  bind_operator_rates(module);
  py::class_<MotionModel> motion_model(module, "MotionModel", doc("mcmc::MotionModel"));
  motion_model.attr("__hash__") = py::none();
  motion_model.def("__copy__", [](const MotionModel& m) { return m; })
      .def("__deepcopy__", [](const MotionModel& m, const py::dict&) { return m; })
      .def("__eq__",
           [](const MotionModel& a, const py::object& b) {
             return py::isinstance<MotionModel>(b) && a == b.cast<const MotionModel&>();
           })
      .def(py::pickle([](const MotionModel& m) { return to_state(mcmc::to_archive(m)); },
                      [](const py::tuple& state) { return mcmc::motion_model(to_archive(state)); }))
      .def_readonly("width", &MotionModel::width, doc("mcmc::MotionModel::width"))
      .def_readonly("height", &MotionModel::height, doc("mcmc::MotionModel::height"))
      .def_readonly("fps", &MotionModel::fps)
      .def_readonly("frames", &MotionModel::frames, doc("mcmc::MotionModel::frames"))
      .def_readwrite("displacement", &MotionModel::displacement, doc("mcmc::MotionModel::displacement"))
      .def_readwrite("contrast", &MotionModel::contrast, doc("mcmc::MotionModel::contrast"))
      .def_readwrite("rates", &MotionModel::rates, doc("mcmc::MotionModel::rates"));
  module.def(
      "rate_interval",
      [](double events, double time, double variance, double prior_events, double prior_time,
         double probability) {
        const auto found = mcmc::rate_interval(events, time, variance, prior_events, prior_time, probability);
        return py::make_tuple(found.mean, found.low, found.high);
      },
      py::arg("events"), py::arg("time"), py::arg("variance") = 0, py::arg("prior_events") = 0.5,
      py::arg("prior_time") = 0, py::arg("probability") = 0.9, doc("mcmc::rate_interval"));
}

}  // namespace emberfold::python
