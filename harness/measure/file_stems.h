// Names of image files of a suite's variants.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/measure/suite.h"

namespace penumbra {

/// By label, the name of a variant's images without extension: file_name() of the label. One that is too long for a
/// file system, or the same as another's up to upper and lower case, ends in the first digits of its label's SHA-1.
/// Depends on the suite alone, so that a resumed run finds its files.
std::map<std::string, std::string> file_stems(const std::vector<Variant>& variants);

}  // namespace penumbra
