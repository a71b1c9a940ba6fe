// What a row can be held against in somebody's paper.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

/// A published time and the rows and stages of ours that it is compared with.
struct PublishedTime {
  std::string table, subject, variant;  ///< of results/published/NAME.csv
  std::string row;                      ///< regular expression searched in row names
  std::vector<std::string> stages;      ///< whose sum is compared; empty: the whole frame
};

}  // namespace penumbra
