// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <pybind11/pybind11.h>

#include "core/context.hpp"

namespace emberfold::python {

namespace py = pybind11;

/// Does `work` on a thread of its own, without the interpreter's lock, while the caller's waits.
/// The waiting thread looks for signals some twenty times a second, so that Ctrl-C asks the work to stop, and
/// hands its progress to `progress` (stage, fraction), unless that is None, and its warnings to Python's. An
/// exception from either asks it to stop, too, and is thrown once it has. `work` may not touch Python.
void run_interruptibly(const py::object& progress, const std::function<void(const core::Context&)>& work);

/// Does `work` as above and returns its result.
template <class Work>
auto call(const py::object& progress, const Work& work) {
  using Result = decltype(work(core::Context{}));
  std::optional<Result> result;
  run_interruptibly(progress, [&](const core::Context& context) { result.emplace(work(context)); });
  return std::move(*result);
}

}  // namespace emberfold::python
