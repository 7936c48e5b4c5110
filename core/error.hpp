// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace emberfold::core {

/// The caller asked for something that cannot be: names what, the value, and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file or device failed, or holds something else than its format promises.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A computation left the range in which its result means anything.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace emberfold::core
