// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::core {

/// Lets the process keep memory that it frees: up to 256 MB, in blocks of up to 32 MB. Drawing frames
/// allocates and frees images by the dozen; if their pages went back to the system each time, touching them
/// again would cost up to a third of the time. For programs, at their start. Does nothing without glibc.
void keep_freed_memory();

/// Returns all memory freed so far to the system, after work that needed much of it. Takes some milliseconds.
/// Does nothing without glibc.
void return_freed_memory();

}  // namespace emberfold::core
