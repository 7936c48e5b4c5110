// SPDX-License-Identifier: Apache-2.0
#include "sketch/fill.hpp"
