// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
inline constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool kAddressSanitizer = false;
#endif

/// By how much a limit on time is to be stretched: sanitizers slow a program down.
inline constexpr double kSlowdown = kAddressSanitizer ? 20 : 1;

}  // namespace emberfold::test
