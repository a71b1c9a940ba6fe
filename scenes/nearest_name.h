// What somebody who mistyped a name may have meant.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

/// The name that `word` becomes by fewest mistakes (a letter left out, added, changed, or two swapped): at most one for
/// words of up to four letters, two for longer ones. Empty if none is as near. Of equally near ones the first.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

/// "; did you mean 'NAME'?", or nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace penumbra
