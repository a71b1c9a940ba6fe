// Several lights: light adds up, so a technique that can shade each of them alone shades all of them, once for each.
#pragma once

#include <functional>

#include "techniques/technique.h"

namespace penumbra {

/// One instance of a technique for each light of a scene; their images are added.
class SeveralLights final : public Technique {
 public:
  /// Makes the technique of the light of that number: what is random should differ from light to light.
  using Make = std::function<std::unique_ptr<Technique>(std::size_t light)>;
  explicit SeveralLights(Make make) : make_(std::move(make)) {}

  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;
  std::map<std::string, std::size_t> counters() const override;
  std::vector<Stage> stages() const override;  ///< those of one name together
  std::string instruction_set() const override;

 private:
  Make make_;
  std::vector<std::unique_ptr<Technique>> parts_;
  std::vector<vec3> radiance_;
};

}  // namespace penumbra
