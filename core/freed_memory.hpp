// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::core {

/// Lets the process keep memory that it frees: up to 256 MB, in blocks of up to 32 MB. Frames are drawn in
/// images that come and go by the dozen; given back to the system each time, their pages cost up to a third
/// of the time when they are touched again. For programs, at their start. Does nothing without glibc.
void keep_freed_memory();

/// Gives all memory that is freed by now back to the system, after work that needed much of it. Some
/// milliseconds. Does nothing without glibc.
void return_freed_memory();

}  // namespace emberfold::core
