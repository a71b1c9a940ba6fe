// Times of repetitions as Google Benchmark writes them: what `benchmarks` of results.json holds.
#pragma once

#include <simdjson.h>

#include <iterator>
#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// Why the times of a row can be used for nothing ("repetition 3 took 0 ms"); "" if they can, or there are none.
std::string unusable_times(const Timing& timing);

/// Entries of one row, each on a line and with a comma behind it: one a repetition, then, of at least two repetitions,
/// mean, median, standard deviation and coefficient of variation. `family`: the row's place in the file. CPU time is
/// the frame's wall time too.
std::string entries_of(const Row& row, std::size_t family);

/// Gives rows the times of their repetitions. `names`: of each row, as the file has it. Throws Error for an entry that
/// belongs to no row, or is not in milliseconds. A time that is no number is NaN.
void add_repetitions(const simdjson::dom::array& entries, const std::vector<std::string>& names,
                     std::vector<Row>& rows);

}  // namespace penumbra
