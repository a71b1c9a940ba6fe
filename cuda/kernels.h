// How the files of kernels reach the registry. `generated/kernel_list.h` is made by CMake from the list of those files.
#pragma once

#include <map>
#include <string>

#include "techniques/registry.h"

namespace penumbra {

/// Makers of the CUDA backend, by technique.
using Makers = std::map<std::string, decltype(Entry::make)>;

/// Every file of kernels defines add_FILE(Makers&): `makers["my-technique"] = maker<MyTechniqueOnDevice>();`.
#define PENUMBRA_DECLARE(file) void add_##file(Makers& makers);
#define PENUMBRA_CALL(file) add_##file(makers);

/// Adds the entries of the CUDA backend: each its scalar twin's but for backend, maker and Kernels::parameters. Without
/// makers (kernels are not built) all are unavailable. Throws std::logic_error if the makers are not those of the
/// entries that have kernels.
void add_cuda_entries(Registry& registry, const Makers& makers, const std::string& unavailable);

}  // namespace penumbra
