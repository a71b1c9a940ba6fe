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
  /// Empty if it can run here, else why not ("no CUDA device").
  std::string unavailable = {};

  std::string title() const { return name + " (" + backend + ")"; }
};

class Registry {
 public:
  /// Throws Error if name and backend are taken, or a parameter is declared twice.
  void add(Entry entry);
  /// Throws Error listing what there is.
  const Entry& find(const std::string& name, const std::string& backend) const;
  /// The backends that nobody has to ask for: of scalar and simd those that the technique has, else all that it has.
  /// Throws Error listing the techniques.
  std::vector<std::string> usual_backends(const std::string& name) const;
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
