// All variants that this build knows. The only list that the harness sees.
#pragma once

#include <functional>
#include <memory>

#include "techniques/parameters.h"
#include "techniques/technique.h"

namespace penumbra {

/// Which lights a technique can shade.
struct LightKinds {
  bool environment = false, area = false;
  bool accepts(const Light& light) const { return environment_of(light) ? environment : area; }
};

/// A parameter that trades time for error: what `penumbra choose` turns. The others keep their defaults.
struct Knob {
  std::string parameter;
  std::vector<ParameterValue> values;  ///< worth trying
  /// Integers in ascending order, along which time grows and error falls, and between which others are worth trying. At
  /// most one knob of a technique.
  bool fine = false;
};

/// One technique on one backend.
struct Entry {
  std::string name, backend;  ///< backend: "scalar", "simd" or "cuda"
  std::string summary, citation;
  LightKinds lights;
  /// A parameter called "resolution" is, by convention, the texels along an edge of a cube face: the rungs `cube` and
  /// `spheres` are then computed at it.
  std::vector<Parameter> parameters;
  std::function<std::unique_ptr<Technique>(const Parameters&)> make;
  /// Relative RMSE up to which a backend may differ from its scalar twin: rounding, and texels or rays that rounding
  /// moves across a silhouette.
  double parity = 1e-5;
  /// Does the image depend on the scene's spheres? What does not is measured once, however many sets a suite asks for.
  std::function<bool(const Parameters&)> reads_spheres = [](const Parameters&) { return true; };
  /// Receivers farther apart than this in their image do not affect each other; 0: each stands alone.
  int reach = 0;
  /// Every combination of their values is worth a look; those that the technique refuses are passed over.
  std::vector<Knob> knobs = {};
  /// What its error is made of beyond texels and spheres, in a word or two: "noise".
  std::string errs_by = {};
  /// Empty if it can run here, else why not ("no CUDA device").
  std::string unavailable = {};

  std::string title() const { return name + " (" + backend + ")"; }
};

class Registry {
 public:
  /// Throws Error if name and backend are taken, a parameter is declared twice, or a knob turns what is not declared or
  /// not allowed.
  void add(Entry entry);
  /// Throws Error listing what there is.
  const Entry& find(const std::string& name, const std::string& backend) const;
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
};

/// Every technique of the project; CUDA variants if they are built in.
Registry make_registry();

/// Checked construction: resolves the parameters against the entry's declaration. Throws Unsupported, with the reason,
/// if the entry is unavailable.
std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters);

}  // namespace penumbra
