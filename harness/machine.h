// What a measurement was taken on and from.
#pragma once

#include <map>
#include <string>

namespace penumbra {

/// cpu_name, instruction_sets, compiler, flags, build_type, commit, dirty, cuda.
std::map<std::string, std::string> describe_machine();

}  // namespace penumbra
