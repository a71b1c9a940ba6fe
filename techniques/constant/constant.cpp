// The smallest technique: the same radiance everywhere, times albedo. A table shows by it the error of knowing nothing
// about a scene; a new technique may begin as its copy.
#include "techniques/registry.h"

namespace penumbra {
namespace {

class Constant final : public Technique {
 public:
  explicit Constant(const Parameters& p) : value_(float(p.number("radiance"))) {}

  void prepare(const Scene& scene, const Light& /*light*/) override {  // once, offline
    receivers_ = &scene.receivers;
  }
  void update(const Frame& frame) override {
    receivers_ = &frame.receivers;
  }                                           // per frame: frame.changed says what is new
  void shade(View<vec3> radiance) override {  // per frame: every receiver
    for (int i = 0; i < receivers_->size(); ++i)
      radiance[i] = receivers_->valid(i) ? receivers_->albedo[i] * value_ : vec3(0.0f);
  }
  Footprint footprint() const override { return {}; }  // it holds nothing of its own

 private:
  float value_;  // W m^-2 sr^-1
  const Receivers* receivers_ = nullptr;
};

}  // namespace

void register_constant(Registry& registry) {
  Entry entry;
  entry.name = "constant";
  entry.summary = "the same radiance everywhere: the error of knowing nothing";
  entry.citation = "none; a template for other techniques";
  entry.lights = {true, true};
  entry.reads_spheres = [](const Parameters&) { return false; };
  entry.parameters = {
      number_parameter("radiance", 1.0, 0.0, 1e6, "W m^-2 sr^-1", "radiance of a receiver whose albedo is 1")};
  entry.make = maker<Constant>();
  registry.add(std::move(entry));
}

}  // namespace penumbra
