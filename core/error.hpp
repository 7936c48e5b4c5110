// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace emberfold::core {

/// Reports an invalid argument: its name, its value and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reports a file or device that failed, or content that violates its format.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reports a computation whose result is not meaningful.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace emberfold::core
