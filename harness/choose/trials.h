// The scene with its counts of spheres, and what has been tried on it.
#pragma once

#include <map>
#include <memory>

#include "harness/choose/bracket.h"
#include "harness/measure/check.h"
#include "harness/results/results_folder.h"

namespace penumbra {

/// The motion of a scene at rest that is asked to move.
inline const Motion twist{Motion::Kind::twist, 0.5f, 16.0f, 16, Carry::rigid, vec3(0.0f)};

/// A configuration that has been shaded once.
struct Trial {
  Variant variant;
  int spheres = 0;  ///< key of its context
  Row row;
  Look look;
};

/// One scene with several counts of spheres; 0 stands for the spheres that the scene itself lists, or none.
class Trials {
 public:
  /// Loads the scene without a fit and computes its truth. Throws Error.
  Trials(std::string scene, bool moving, double truth_noise, ResultsFolder& folder, Progress& progress);

  const SceneContext& context(int spheres) const { return *contexts_.at(spheres).whole; }
  const Suite& suite() const { return suite_; }
  /// May spheres be fitted? Where the scene lists its own, or has no mesh, they may not.
  bool may_fit() const { return may_fit_; }
  bool has_spheres(int spheres) const { return contexts_.contains(spheres); }
  /// Fits so many spheres and computes what the few receivers below need. Throws Error.
  void fit(int spheres);

  /// Shades once, unless that was done; absent if it cannot be shaded. The row joins the folder, with the one look as
  /// its time.
  const Trial* look(const Variant& variant, int spheres);
  /// Why configurations could not be shaded, by technique.
  const std::map<std::string, std::string>& refusals() const { return refusals_; }
  const std::vector<std::unique_ptr<Trial>>& all() const { return all_; }

  /// Where the error of a configuration comes from: shaded once more at few receivers, of which all rungs are known.
  Score anatomy(const Variant& variant, int spheres) const;
  /// Relative RMSE from truth to rung cube at these receivers; absent where there is none.
  std::optional<double> texel_error(int spheres, int resolution) const;
  /// Relative RMSE from rung cube to rung spheres: what so many spheres cost whatever shades with them.
  std::optional<double> sphere_error(int spheres) const;

 private:
  struct Contexts {
    std::unique_ptr<SceneContext> whole, few;
  };
  Scene load(int spheres);
  void add_context(int spheres);

  const std::string scene_;
  const bool moving_;
  Suite suite_;
  bool may_fit_ = false;
  ResultsFolder& folder_;
  Progress& progress_;
  std::map<int, Contexts> contexts_;
  std::vector<std::unique_ptr<Trial>> all_;
  std::map<std::string, const Trial*> by_name_;  ///< null: refused
  std::map<std::string, std::string> refusals_;
};

}  // namespace penumbra
