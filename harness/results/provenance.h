// May rows of two runs stand under one context?
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace penumbra {

/// Which of some fields of two contexts differ, in words; empty if none does.
std::string difference_of(const std::vector<const char*>& fields, const nlohmann::json& then,
                          const nlohmann::json& now);

/// What of the program or the machine differs between two contexts, in words ("commit a1b2c3d4e5 then, 0f9e8d7c6b
/// now"); empty if rows of both may be mixed. Load, clocks and dates may differ.
std::string difference(const nlohmann::json& then, const nlohmann::json& now);

}  // namespace penumbra
