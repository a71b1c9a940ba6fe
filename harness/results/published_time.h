// What a row can be held against in somebody's paper.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace penumbra {

/// A published time and the rows and stages of ours that it is compared with.
struct PublishedTime {
  std::string table, subject, variant;  ///< of results/published/NAME.csv
  std::string row;                      ///< regular expression searched in row names
  std::vector<std::string> stages;      ///< whose sum is compared; empty: the whole frame
};

/// As results.json keeps them in its context under "published_times", beside "published", the name of their table.
nlohmann::json to_json(const std::vector<PublishedTime>& times);
/// What to_json() has written. Throws Error if it is something else.
std::vector<PublishedTime> published_times_from(const nlohmann::json& json);

}  // namespace penumbra
