// All variants that this build knows. The only list that the harness sees.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "techniques/parameters.h"
#include "techniques/technique.h"

namespace penumbra {

/// Which lights a technique can shade, alone or together with others.
struct LightKinds {
  bool environment = false, area = false;
  bool accepts(const Light& light) const {
    for (const Light& one : each_of(light))
      if (!(environment_of(one) ? environment : area)) return false;
    return true;
  }
};

/// A parameter that trades time for error: what `penumbra choose` turns. The others keep their defaults.
struct Knob {
  std::string parameter;
  std::vector<ParameterValue> values;  ///< worth trying
  /// Integers in ascending order, along which time grows and error falls, and between which others are worth trying. At
  /// most one knob of a technique.
  bool fine = false;
};

/// What runs a technique: plain loops, vector instructions, a GPU; or another program, of which only images are known.
enum class Backend { scalar, simd, cuda, external };
std::string to_string(Backend backend);

/// What a technique's kernels have beyond its other backends.
struct Kernels {
  std::vector<Parameter> parameters = {};  ///< that only the device has
  /// Besides the default: what `kernel_counts` and `kernel_times` run so that every kernel runs once.
  std::vector<Parameters> workloads = {};
};

/// One technique on one backend.
struct Entry {
  std::string name;
  Backend backend = Backend::scalar;
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
  /// Of the scalar entry: there is a file in `cuda/` that runs the technique on a GPU.
  std::optional<Kernels> kernels = {};
  /// Values with which the technique does all that it does, but quickly: what tests run where speed is not the point.
  Parameters small = {};
  /// Empty if it can run here, else why not ("no CUDA device").
  std::string unavailable = {};

  std::string title() const { return name + " (" + to_string(backend) + ")"; }
};

/// How a backend stands in this build on this machine.
struct BackendState {
  std::string status;                                           ///< one line for listings
  std::function<std::map<std::string, std::string>()> context;  ///< asks for what results must tell; null: unavailable
  bool available() const { return context != nullptr; }
};

class Registry {
 public:
  /// Throws Error if name and backend are taken, a parameter is declared twice, or a knob turns what is not declared or
  /// not allowed.
  void add(Entry entry);
  /// Throws Error listing what there is.
  const Entry& find(const std::string& name, const std::string& backend) const;
  const Entry& find(const std::string& name, Backend backend) const { return find(name, to_string(backend)); }
  /// The same technique on another backend; null where it has none.
  const Entry* twin(const Entry& entry, Backend backend) const;
  /// The backends that nobody has to ask for: of scalar and simd those that the technique has, else all that it has.
  /// Throws Error listing the techniques.
  std::vector<Backend> usual_backends(const std::string& name) const;
  const std::vector<Entry>& entries() const { return entries_; }

  void set_state(Backend backend, BackendState state) { states_[backend] = std::move(state); }
  /// Of the backends that need more than a processor.
  const std::map<Backend, BackendState>& states() const { return states_; }

 private:
  std::vector<Entry> entries_;
  std::map<Backend, BackendState> states_;
};

template <class Implementation>
auto maker() {
  return [](const Parameters& p) -> std::unique_ptr<Technique> { return std::make_unique<Implementation>(p); };
}

/// Adds `entry` twice: with the plain loops, and with their vectorised twin. They differ in nothing else.
template <class Scalar, class Simd>
void add_pair(Registry& registry, Entry entry) {
  entry.backend = Backend::scalar, entry.make = maker<Scalar>();
  registry.add(entry);
  entry.backend = Backend::simd, entry.make = maker<Simd>(), entry.kernels.reset();
  registry.add(std::move(entry));
}

/// Checked construction: resolves the parameters against the entry's declaration. Throws Unsupported, with the reason,
/// if the entry is unavailable.
std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters);
/// For a scene's light: where there are several, one technique for each (techniques/several_lights.h).
std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters, const Light& light);

}  // namespace penumbra
