// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::test {

/// By how much a limit on time is to be stretched: sanitizers slow a program down.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr double kSlowdown = 20;
#else
inline constexpr double kSlowdown = 1;
#endif

}  // namespace emberfold::test
