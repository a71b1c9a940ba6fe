// What sources throw: Error for wrong input, Unsupported for what is not wrong, but cannot be.
#pragma once

#include "scenes/storage/error.h"
#include "scenes/unsupported.h"
