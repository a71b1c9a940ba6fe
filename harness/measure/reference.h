// The reference ladder: truth -> cube -> spheres (docs/references.md). Every error is attributed by climbing it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenes/image.h"
#include "scenes/scene.h"

namespace penumbra {

/// truth:   the mesh and the light at full resolution; area lights sampled densely
/// r13x13:  area lights only: 13 x 13 cell centres, as published (Yang et al. 2019)
/// cube:    environments only: the mesh, light and visibility at 6 x n x n texels, one ray per texel centre
/// spheres: environments only: the sphere set instead of the mesh, same texels, exact cap test
enum class Rung { truth, r13x13, cube, spheres };
std::string to_string(Rung rung);
/// Throws Error listing the names.
Rung parse_rung(const std::string& name);

struct ReferenceSettings {
  int resolution = 32;         ///< n of cube and spheres
  double truth_noise = 0.002;  ///< truth samples until its standard error is below this share of its RMS
  int most_rays = 1 << 16;     ///< per receiver, even if the noise is not reached
};

/// Mean radiance and its variance per receiver (0 for deterministic rungs), and what would arrive without occluder.
struct Reference {
  Rung rung = Rung::truth;
  Image mean, variance, unshadowed;
  int rays_per_receiver = 0;
  double seconds = 0.0;  ///< time it took to compute (not to load)
  bool from_cache = false;
  /// Standard error of the whole image: RMS over valid receivers and channels, W m^-2 sr^-1.
  double noise(const std::vector<bool>& valid) const;
};

std::vector<bool> valid_receivers(const Receivers& receivers);

/// Why a rung does not apply to a frame; empty if it does.
std::string inapplicable(const Frame& frame, Rung rung);

/// Throws Error naming the first receiver of a reference that is not finite.
void check_finite(const Reference& reference, const Receivers& receivers);

/// Warns of a truth whose noise is above what was asked for, and says what to do.
void warn_of_noise(const Reference& reference, const Receivers& receivers, const ReferenceSettings& settings);

/// Told now and then how far a reference is, share in [0, 1], on any thread.
using ReferenceProgress = std::function<void(double share)>;

/// Computes a rung; the bits do not depend on the number of threads. Throws Unsupported where it does not apply, Error
/// if it is not finite, Interrupted if the run is to stop.
Reference compute_reference(const Frame& frame, Rung rung, const ReferenceSettings& settings,
                            const ReferenceProgress& progress = {});

/// Visibility of the 13 x 13 cell centres of an area light: values k / 169.
float visibility_13x13(const Frame& frame, int receiver);

/// SHA-1 over everything a rung depends on.
std::string reference_key(const Frame& frame, Rung rung, const ReferenceSettings& settings);

/// Does the cache folder hold a rung? Its file is not looked into.
bool is_cached(const Frame& frame, Rung rung, const ReferenceSettings& settings);

/// A rung from the cache folder if it holds a whole file with the right key; computed and stored otherwise. Files that
/// are truncated, damaged or of another key are rebuilt with a warning. An unwritable cache is a warning, not an error.
Reference cached_reference(const Frame& frame, Rung rung, const ReferenceSettings& settings,
                           const ReferenceProgress& progress = {});

}  // namespace penumbra
