// The interface behind which every technique sits: one algorithm on one backend with fixed parameters.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace penumbra {

/// Row-major, row 0 first; not owned.
template <class T>
struct View {
  T* data;
  int width, height;
  T& operator[](std::size_t i) const { return data[i]; }
  std::size_t size() const { return std::size_t(width) * height; }
};

/// Bytes that a technique holds.
struct Footprint {
  std::size_t tables = 0;     ///< the same for every scene
  std::size_t per_scene = 0;  ///< grows with mesh, light or receivers; stays over frames
  std::size_t per_frame = 0;  ///< rewritten by update()
  std::size_t total() const { return tables + per_scene + per_frame; }
};

/// A named part of update() or shade() and how long its last run took. Stages need not add up to the whole.
struct Stage {
  std::string name;
  double ms;
};

/// An image on the way from the rung `spheres` to a technique's own: one more of its approximations is in it.
struct Approximation {
  std::string name;            ///< of what this image adds to the one before
  std::vector<vec3> radiance;  ///< receivers in row order; empty in the last: the technique's own image
};

/// Measures what a backend does: the time of the machine that does it.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual void start() = 0;
  virtual double lap() = 0;  ///< milliseconds since start() or the lap before
};

/// The CPU's.
class SteadyClock final : public Clock {
 public:
  void start() override { last_ = std::chrono::steady_clock::now(); }
  double lap() override {
    const auto before = last_;
    start();
    return std::chrono::duration<double, std::milli>(last_ - before).count();
  }

 private:
  std::chrono::steady_clock::time_point last_;
};

class Technique {
 public:
  virtual ~Technique() = default;

  /// Once per scene, offline: builds tables and takes in the scene at rest. May be slow; timed apart. `light` is the
  /// scene's, or one of its lights (techniques/several_lights.h). Throws Unsupported where the technique makes no sense
  /// on the scene. Scene and light outlive the technique.
  virtual void prepare(const Scene& scene, const Light& light) = 0;
  void prepare(const Scene& scene) { prepare(scene, scene.light); }

  /// Per frame: all that depends on the frame and is shared by receivers. Only what `frame.changed` names differs from
  /// the frame (or scene) before. The frame stays valid until the next update().
  virtual void update(const Frame& frame) = 0;

  /// Per frame: outgoing radiance of every receiver, linear RGB, W m^-2 sr^-1, receivers in row order.
  virtual void shade(View<vec3> radiance) = 0;

  virtual Footprint footprint() const = 0;

  /// Events of the last update() and shade() that a reader of the image should know of, by name: values that were
  /// clamped or not finite, input that was left out.
  virtual std::map<std::string, std::size_t> counters() const { return {}; }

  /// Sub-stages of the last update() and shade(), in order of running; 0 ms where one had nothing to do.
  virtual std::vector<Stage> stages() const { return {}; }

  /// For the frame of the last update(): what each approximation adds to the error, if the technique can tell them
  /// apart. Not timed.
  virtual std::vector<Approximation> approximations() const { return {}; }

  /// What update() and shade() are timed with.
  virtual std::unique_ptr<Clock> make_clock() const { return std::make_unique<SteadyClock>(); }

  /// Instruction set that the inner loops run on, e.g. "AVX3"; empty for plain code.
  virtual std::string instruction_set() const { return ""; }
};

}  // namespace penumbra
