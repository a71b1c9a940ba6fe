// Figures that follow from rows.
#pragma once

#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// Is `a` faster than `b` by more than the noise of both? Half the interquartile range of either counts as its noise;
/// within the sum of the two, times are ties. False where one of them has not been timed.
bool faster(const Row& a, const Row& b);

/// Is `a` nearer to the truth than `b`? Errors that are ties with an exact image (RungErrors::tie) are ties with each
/// other. False where one of them is undefined.
bool nearer(const Row& a, const Row& b);

/// The best of some rows within an error against truth (ties are within any): the fastest; of rows that are as fast
/// within the noise of both, the nearest to the truth. Null if none is within.
const Row* best_within(double limit, const std::vector<const Row*>& rows);

/// Rows of one scene that no other row beats: one that is faster and not farther from the truth, or nearer and not
/// slower. A row whose error is undefined, or that has no time, neither is optimal nor beats another.
std::vector<bool> pareto_optimal(const std::vector<const Row*>& rows);

}  // namespace penumbra
