// One of two programs that are measured in turn: times rows of a suite when it is told to, and waits.
#pragma once

#include <istream>
#include <ostream>

#include "harness/measure/plan.h"

namespace penumbra {

/// What the two sides of a comparison agree on; of another version, nothing is understood.
inline constexpr int row_server_protocol = 1;

/// Answers every line of `in`, a JSON object, with one on `out`, until there is none. The first line on `out`, unasked,
/// is {"protocol": 1}. Then, `row` being the key of a row
/// (Facts::key), which does not depend on how rows are called:
///   {"scene": name, "row": row}   loads the scene that has the row   {}
///   {"prepare": row}              prepares and warms up              {"frame_ms": of one frame}
///   {"time": row, "frames": n}    one repetition                     {"update_ms", "shade_ms", "cpu_ms", "stages":
///   [[name, ms]]}
/// What goes wrong is {"error": why}.
void serve_rows(const Plan& plan, std::istream& in, std::ostream& out);

}  // namespace penumbra
