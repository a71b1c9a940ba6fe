#include "harness/results/published_time.h"

#include "scenes/error.h"

namespace penumbra {

nlohmann::json to_json(const std::vector<PublishedTime>& times) {
  nlohmann::json all = nlohmann::json::array();
  for (const PublishedTime& time : times)
    all.push_back({{"table", time.table},
                   {"subject", time.subject},
                   {"variant", time.variant},
                   {"row", time.row},
                   {"stages", time.stages}});
  return all;
}

std::vector<PublishedTime> published_times_from(const nlohmann::json& json) {
  std::vector<PublishedTime> times;
  try {
    times.reserve(json.size());
    for (const nlohmann::json& at : json)
      times.push_back({at.at("table"), at.at("subject"), at.at("variant"), at.at("row"),
                       at.at("stages").get<std::vector<std::string>>()});
  } catch (const nlohmann::json::exception& e) {
    throw Error("context.published_times is not what a run writes: {}", e.what());
  }
  return times;
}

}  // namespace penumbra
