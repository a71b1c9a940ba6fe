// scripts/report in Python: where it is, what runs it, what it lacks.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

/// $PENUMBRA_PYTHON; else .venv/bin/python beside the data's folder; else python3 of $PATH.
std::string page_python();

/// Runs the script with these arguments, and passes on what it says, as it comes, to standard error. Returns its exit
/// code, 1 if it was killed. Throws Error if it is not there, or if Python lacks one of its packages, and says which
/// file lists them; Interrupted.
int run_page_script(const std::vector<std::string>& arguments);

}  // namespace penumbra
