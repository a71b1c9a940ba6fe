// What a run would do, without doing it.
#pragma once

#include "harness/commands/run.h"

namespace penumbra {

/// Prints the rows of a suite, the fits and references that they need and which of these are in the cache, and about
/// how long all that takes. Scenes are loaded, but nothing is fitted, measured or written. Throws Error for wrong
/// input, as run_suite() would.
void dry_run(const Suite& suite, const RunOptions& options);

}  // namespace penumbra
