// Loops over receivers, rows or tiles in parallel.
#pragma once

#include <tbb/parallel_for.h>

namespace penumbra {

/// Calls work(begin, end) for ranges of `grain` or more that make up [0, count), on the threads of the arena that it is
/// called in.
template <class Work>
void for_ranges(int count, int grain, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<int>(0, count, grain),
                    [&](const tbb::blocked_range<int>& range) { work(range.begin(), range.end()); });
}

}  // namespace penumbra
