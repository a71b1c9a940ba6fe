// Image errors. Every function has a hand-computed test; SSIM and FLIP are checked against independent implementations.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scenes/image.h"

namespace penumbra {

/// Where a receiver lies, judged by the reference: reflected over unshadowed luminance.
enum class Region : std::uint8_t { none, umbra, penumbra, lit };
inline constexpr std::array<const char*, 3> region_names = {"umbra", "penumbra", "lit"};

/// Every receiver's region: under 2 % is umbra, over 98 % lit; none where nothing is seen or would arrive unshadowed.
std::vector<Region> classify(const std::vector<vec3>& reference, const std::vector<vec3>& unshadowed,
                             const std::vector<bool>& valid);

/// An error over a scale. Absent where the scale is black (at most `black`): 0 / 0 is neither no error nor a large one.
std::optional<double> relative(double error, double scale, double black = 0.0);

/// Errors over one set of receivers; without receivers none of them means anything. Radiometric ones in linear radiance
/// over all channels; ssim and flip on the tone-mapped image, absent where the image is too small for a window (vertex
/// receivers).
struct Errors {
  std::size_t receivers = 0;
  double rmse = 0.0;               ///< W m^-2 sr^-1
  std::optional<double> rel_rmse;  ///< rmse / RMS of the reference over all valid receivers; absent if that is black
  std::optional<double> psnr;  ///< dB, peak = largest reference value of the image; infinity if equal; absent if black
  double max = 0.0;            ///< largest absolute error of a channel, W m^-2 sr^-1
  double mean_signed = 0.0;    ///< mean of image - reference: > 0 leaks light, < 0 over-darkens; W m^-2 sr^-1
  std::size_t negative = 0;    ///< channel values of the image below 0: truncation makes them, nothing clamps them
  std::optional<double> ssim, flip;
};

struct ErrorReport {
  Errors all;
  std::array<Errors, 3> region;  ///< umbra, penumbra, lit
};

/// `exposure` brings radiance to the display range and is fixed per scene. A reference whose RMS is at most `black` is
/// black (harness/measure/black_truth.h).
ErrorReport compare_images(const Image& image, const Image& reference, const std::vector<Region>& regions,
                           const std::vector<bool>& valid, double exposure, double black = 0.0);

/// RMS over valid receivers and channels, W m^-2 sr^-1; 0 if none is valid.
double rms(const Image& image, const std::vector<bool>& valid);

/// The signed error, image - reference, receiver by receiver.
Image difference(const Image& image, const Image& reference);

/// Mean of every channel over valid receivers, W m^-2 sr^-1; absent if none is valid.
std::optional<dvec3> mean(const Image& image, const std::vector<bool>& valid);

/// Exposure that maps the brightest percentile of a reference to 0.8 of white; if that is black, its brightest value;
/// if all is, `light` (light_scale() of harness/measure). 1 if there is no light either.
double exposure_for(const Image& reference, const std::vector<bool>& valid, double light = 0.0);

/// Grey display image in [0, 1]: sRGB-encoded, exposed and clipped luminance.
std::vector<float> display_luminance(const Image& image, double exposure);

/// Structural similarity per pixel (Wang et al. 2004): 11 x 11 Gaussian window, sigma 1.5, K1 = 0.01, K2 = 0.03, range
/// 1. Pixels closer than 5 to the border have no full window and are NaN. Empty if the image is smaller than a window.
std::vector<float> ssim_map(const std::vector<float>& a, const std::vector<float>& b, int width, int height);

/// FLIP per pixel (Andersson et al. 2020, 67 pixels per degree) of HDR images at one fixed exposure factor with the
/// ACES tone mapper of HDR-FLIP (Andersson et al. 2021).
std::vector<float> flip_map(const Image& image, const Image& reference, double exposure);

}  // namespace penumbra
