// SPDX-License-Identifier: Apache-2.0
#include "sketch/render.hpp"

#include "tests/catch.hpp"
