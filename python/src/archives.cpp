// SPDX-License-Identifier: Apache-2.0
#include "python/src/archives.hpp"

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <pybind11/numpy.h>

#include "core/error.hpp"

namespace emberfold::python {

namespace {

namespace py = pybind11;

template <class Value>
py::dtype dtype_of() {
  if constexpr (std::is_same_v<Value, core::Half>)
    return py::dtype("e");
  else
    return py::dtype::of<Value>();
}

py::array to_python(const core::NpyArray& array) {
  return std::visit(
      [&](const auto& data) {
        using Value = typename std::decay_t<decltype(data)>::value_type;
        std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end()), strides(shape.size());
        auto step = static_cast<py::ssize_t>(sizeof(Value));
        for (std::size_t i = 0; i < shape.size(); ++i) {
          const std::size_t axis = array.fortran_order ? i : shape.size() - 1 - i;
          strides[axis] = step;
          step *= shape[axis];
        }
        return py::array(dtype_of<Value>(), shape, strides, data.data());
      },
      array.data);
}

template <class Value>
bool read_as(const py::array& given, core::NpyArray& array) {
  if (!given.dtype().equal(dtype_of<Value>())) return false;
  const auto* first = static_cast<const Value*>(given.data());
  array.data = std::vector<Value>(first, first + given.size());
  return true;
}

core::NpyArray from_python(const py::handle& object) {
  core::NpyArray array;
  auto given = object.cast<py::array>();
  const bool fortran = (given.flags() & py::array::f_style) != 0 && (given.flags() & py::array::c_style) == 0;
  array.fortran_order = fortran;
  given = py::array::ensure(given, fortran ? py::array::f_style : py::array::c_style);
  for (py::ssize_t i = 0; i < given.ndim(); ++i)
    array.shape.push_back(static_cast<std::size_t>(given.shape(i)));
  if (!(read_as<float>(given, array) || read_as<double>(given, array) ||
        read_as<std::uint8_t>(given, array) || read_as<std::uint16_t>(given, array) ||
        read_as<std::int32_t>(given, array) || read_as<std::int64_t>(given, array) ||
        read_as<core::Half>(given, array)))
    throw core::IoError("a model's array has a type that models do not hold");
  return array;
}

}  // namespace

py::tuple to_state(const core::ModelArchive& archive) {
  py::dict arrays;
  for (const auto& [name, array] : archive.arrays) arrays[py::str(name)] = to_python(array);
  return py::make_tuple(archive.text, arrays);
}

core::ModelArchive to_archive(const py::tuple& state) {
  core::ModelArchive archive{state[0].cast<std::string>(), {}};
  for (const auto& [name, array] : state[1].cast<py::dict>())
    archive.arrays[name.cast<std::string>()] = from_python(array);
  return archive;
}

bool equal(const core::ModelArchive& a, const core::ModelArchive& b) {
  return a.text == b.text && a.arrays == b.arrays;
}

}  // namespace emberfold::python
