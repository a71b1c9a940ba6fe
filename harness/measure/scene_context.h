// What the variants of one scene are measured against: its scored frame and the references of that frame.
#pragma once

#include "harness/measure/plan.h"
#include "harness/measure/progress.h"
#include "harness/measure/sequence.h"

namespace penumbra {

/// Hash of all that the truth of a scene's scored frame depends on; spheres are not part of it.
std::string truth_key(const Scene& scene, const Suite& suite);

class SceneContext {
 public:
  /// Takes the scored frame, or another. Throws Error if the scene has no such frame.
  SceneContext(Scene scene, const Suite& suite, std::optional<int> frame = {});
  SceneContext(const SceneContext&) = delete;
  SceneContext& operator=(const SceneContext&) = delete;

  const Scene& scene() const { return scene_; }
  const Frame& frame() const { return frame_; }  ///< what images are of
  const Animation& animation() const { return animation_; }
  const std::string& key() const { return key_; }
  /// "scene-64-spheres-shadow": its images lie there.
  std::string folder() const;

  /// Adds a rung, from the cache or computed. Throws Error if it is not finite, Interrupted if the run is to stop.
  void add_reference(Rung rung, int resolution, const ReferenceProgress& progress = {});
  /// Shades with a variant; its image joins the references. Throws what the variant throws.
  void add_baseline(const Variant& variant);
  /// Adds the truths of every frame; says how far they are as the share of a step.
  void add_sequence(Progress& progress);
  /// Once all references are there: says what is odd about the scene.
  void finish_references(Progress& progress);

  /// Errors against everything that was added.
  Score score(const Image& image, const Parameters& parameters) const;
  /// Errors of a prepared technique over the frames of the sequence, if there is one.
  std::optional<SequenceErrors> score_sequence(Technique& technique, const std::string& sheet_file) const;
  /// What each approximation of a technique that has shaded adds to its error; empty if it does not know.
  std::vector<StepError> attribute(const Technique& technique, const Image& image, const Parameters& parameters) const;

  /// Relative RMSE of a rung against truth; absent if it was not added, or the truth is black.
  std::optional<double> error_of(Rung rung, int resolution) const;

  /// Why the truth is black; empty if it is not.
  std::string blackness() const;

  /// Median of three runs of the camera's rays, ms; -1 without a camera.
  double view_ms(int threads) const;

  const Image& truth() const { return references_.at({Rung::truth, 0}).mean; }
  double exposure() const { return exposure_; }

 private:
  struct Known {
    Image mean;
    double noise;
  };
  const Image* rung(Rung rung, int resolution) const;
  void warn_of_sizes(Progress& progress) const;
  void warn_of_spheres(Progress& progress) const;

  const Scene scene_;
  ReferenceSettings settings_;
  std::string key_;
  Animation animation_;
  const Frame frame_;
  std::vector<bool> valid_;
  double light_, black_;                              ///< light_scale() and black_level() of the scored frame
  std::map<std::pair<Rung, int>, Known> references_;  ///< by rung and resolution (0 where it has none)
  bool open_light_ = false;                           ///< would light arrive without an occluder?
  std::vector<Region> regions_;
  std::optional<Sequence> sequence_;
  std::optional<std::pair<std::string, Image>> baseline_;  ///< by name of its technique
  mutable std::map<int, double> view_ms_;                  ///< by threads
  double exposure_ = 1.0;
};

}  // namespace penumbra
