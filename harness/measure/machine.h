// What a measurement was taken on and from.
#pragma once

#include <map>
#include <string>

namespace penumbra {

class Registry;

/// cpu_name, instruction_sets, compiler, flags, build_type, program, commit, dirty, cuda and, with a device, cuda_...
std::map<std::string, std::string> describe_machine(const Registry& registry);

}  // namespace penumbra
