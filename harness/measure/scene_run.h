// One scene of a run: its references, its variants, their rows.
#pragma once

#include "harness/measure/progress.h"
#include "harness/measure/sequence.h"
#include "harness/measure/timing.h"

namespace penumbra {

/// Names and inputs of a variant on a scene, nothing measured.
Row row_of(const Scene& scene, const Variant& variant);

class SceneRun {
 public:
  /// The scene and registry must outlive this.
  SceneRun(const Scene& scene, const Registry& registry, const Suite& suite, std::string image_directory);

  const std::string& key() const { return key_; }
  Row empty_row(const Variant& variant) const;
  /// Truths of every frame: variants checked after this are scored over the whole motion too.
  void make_sequence(Progress& progress);
  /// Says so if the truth is black. Throws Error if a reference is not finite.
  void make_references(const std::vector<Variant>& variants, Progress& progress);
  /// Checks every variant, times those that pass, and scores them. Rows come in the order of the variants; when
  /// interrupted, unfinished ones are left out.
  std::vector<Row> measure(const std::vector<Variant>& variants, int repetitions, Progress& progress);
  /// Shades the suite's baseline; its image joins the references. A baseline that cannot shade the scene is left out
  /// with a note.
  void make_baseline(const Variant& variant, Progress& progress);
  static int steps(std::size_t variants, int repetitions) { return int(variants) * (1 + repetitions) + 1; }

 private:
  struct Candidate {
    Row row;
    std::unique_ptr<Technique> technique;
    Image image;
    double estimate_ms = 1.0;
  };
  Candidate check(const Variant& variant) const;
  void shade_and_score(const Variant& variant, Candidate& candidate) const;
  double view_ms(int threads) const;
  void score(const Image& image, const Parameters& parameters, Row& row) const;
  void write_images(const std::string& stem, const Image& image) const;
  void write_overview(const std::vector<Candidate>& candidates) const;
  const Reference& truth() const { return references_.at({Rung::truth, 0}); }

  const Scene& scene_;
  const Registry& registry_;
  ReferenceSettings settings_;
  bool attribution_;
  std::map<std::string, std::string> stems_;  ///< of image files, by label
  std::string image_directory_, key_;
  Animation animation_;
  Frame frame_;  ///< the scored frame: a third through the motion
  std::vector<bool> valid_;
  double light_, black_;                                  ///< light_scale() and black_level() of the scored frame
  std::map<std::pair<Rung, int>, Reference> references_;  ///< by rung and resolution (0 where it has none)
  std::vector<Region> regions_;
  std::optional<Sequence> sequence_;
  std::optional<std::pair<std::string, Reference>> baseline_;  ///< by name of its technique
  mutable std::map<int, double> view_ms_;                      ///< by threads
  double exposure_ = 1.0;
};

/// "resolution" of a variant's parameters, 32 if it has none.
int resolution_of(const Parameters& parameters);

}  // namespace penumbra
