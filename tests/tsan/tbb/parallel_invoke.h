// SPDX-License-Identifier: MIT
#include "../own_loop.h"
