#include "harness/measure/side_by_side/row_server.h"

#include <tbb/task_arena.h>

#include <map>
#include <nlohmann/json.hpp>

#include "harness/measure/check.h"
#include "harness/measure/timing.h"
#include "harness/results/text.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// A technique that is ready to be timed.
struct Prepared {
  Prepared(const Variant& variant, const Scene& scene)
      : technique(make_technique(*variant.entry, variant.parameters, scene.light)),
        animation(scene),
        threads(variant.threads) {}
  std::unique_ptr<Technique> technique;
  Animation animation;
  int threads;
};

class Server {
 public:
  explicit Server(const Plan& plan) : plan_(plan) {}

  json answer(const json& question) {
    if (question.contains("time")) return time(question.at("time"), question.at("frames"));
    if (question.contains("prepare")) return prepare(question.at("prepare"));
    return load(question.at("scene"), question.at("row"));
  }

 private:
  /// A scene may be planned with several sets of spheres.
  json load(const std::string& scene, const std::string& row) {
    if (variants_.contains(row)) return json::object();
    for (const PlannedScene& planned : plan_.scenes) {
      if (planned.outline.name != scene) continue;
      prepared_.clear(), variants_.clear();
      context_.emplace(load_scene(planned.listed, planned.choice), *plan_.suite);
      for (const Job& job : planned.jobs)
        if (job.kind == Job::Kind::measurement) {
          const Variant& variant = plan_.suite->variants[job.variant];
          variants_.emplace(empty_row(variant, *context_, *plan_.suite).facts.key, &variant);
        }
      if (variants_.contains(row)) return json::object();
    }
    throw Error("scene '{}' of suite '{}' has no row of key {}", scene, plan_.suite->name, row);
  }

  json prepare(const std::string& row) {
    const Variant& variant = *variants_.at(row);
    prepared_.erase(row);
    Prepared& prepared = prepared_.try_emplace(row, variant, context_->scene()).first->second;
    tbb::task_arena(variant.threads).execute([&] { prepared.technique->prepare(context_->scene()); });
    RepetitionTimer timer = timer_of(prepared);
    timer.frame();  // cold
    return {{"frame_ms", timer.frame()}};
  }

  json time(const std::string& row, long frames) {
    RepetitionTimer timer = timer_of(prepared_.at(row));
    for (long k = 0; k < frames; ++k) timer.frame();
    Timing timing;
    timer.add_to(timing);
    json stages = json::array();
    for (const StageSamples& stage : timing.stages) stages.push_back({stage.name, stage.ms[0]});
    return {{"update_ms", timing.update_ms[0]},
            {"shade_ms", timing.shade_ms[0]},
            {"cpu_ms", timing.cpu_ms[0]},
            {"stages", stages}};
  }

  RepetitionTimer timer_of(Prepared& prepared) {
    return {*prepared.technique, prepared.animation, prepared.threads, image_};
  }

  const Plan& plan_;
  std::optional<SceneContext> context_;
  std::map<std::string, const Variant*> variants_;  ///< of the scene, by keys of rows
  std::map<std::string, Prepared> prepared_;
  std::vector<vec3> image_;
};

}  // namespace

void serve_rows(const Plan& plan, std::istream& in, std::ostream& out) {
  out << json{{"protocol", row_server_protocol}} << std::endl;
  Server server(plan);
  for (std::string line; std::getline(in, line);) {
    json answer;
    try {
      answer = server.answer(json::parse(line));
    } catch (const std::exception& e) {
      answer = {{"error", e.what()}};
    }
    out << answer.dump(-1, ' ', false, json::error_handler_t::replace) << std::endl;
  }
}

}  // namespace penumbra
