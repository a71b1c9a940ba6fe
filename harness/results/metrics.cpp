#include "harness/results/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/results/filter.h"
#include "scenes/colour.h"

namespace penumbra {

std::vector<Region> classify(const std::vector<vec3>& reference, const std::vector<vec3>& unshadowed,
                             const std::vector<bool>& valid) {
  std::vector<Region> regions(reference.size(), Region::none);
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const float open = luminance(unshadowed[i]);
    if (!valid[i] || !(open > 0.0f)) continue;
    const float ratio = luminance(reference[i]) / open;
    regions[i] = ratio < 0.02f ? Region::umbra : ratio > 0.98f ? Region::lit : Region::penumbra;
  }
  return regions;
}

std::optional<double> relative(double error, double scale, double black) {
  return scale > black ? std::optional(error / scale) : std::nullopt;
}

namespace {

/// Running sums of one set of receivers.
struct Sums {
  std::size_t count = 0, windows = 0, negative = 0;
  double squared = 0.0, sum = 0.0, largest = 0.0, ssim = 0.0, flip = 0.0;

  void add(vec3 image, vec3 reference) {
    ++count;
    for (int c = 0; c < 3; ++c) {
      const double d = double(image[c]) - double(reference[c]);
      negative += image[c] < 0.0f;
      squared += d * d;
      sum += d;
      largest = std::max(largest, std::abs(d));
    }
  }

  Errors finish(double reference_rms, double peak, double black, bool has_flip) const {
    Errors e;
    e.receivers = count;
    if (count == 0) return e;
    e.rmse = std::sqrt(squared / (3.0 * double(count)));
    e.rel_rmse = relative(e.rmse, reference_rms, black);
    if (e.rel_rmse) e.psnr = e.rmse > 0.0 ? 20.0 * std::log10(peak / e.rmse) : std::numeric_limits<double>::infinity();
    e.max = largest;
    e.negative = negative;
    e.mean_signed = sum / (3.0 * double(count));
    if (windows > 0) e.ssim = ssim / double(windows);
    if (has_flip) e.flip = flip / double(count);
    return e;
  }
};

}  // namespace

ErrorReport compare_images(const Image& image, const Image& reference, const std::vector<Region>& regions,
                           const std::vector<bool>& valid, double exposure, double black) {
  const std::size_t size = reference.pixels.size();
  const std::vector<float> ssim = ssim_map(display_luminance(image, exposure), display_luminance(reference, exposure),
                                           reference.width, reference.height);
  const bool windowed = !ssim.empty();
  const std::vector<float> flip = windowed ? flip_map(image, reference, exposure) : std::vector<float>();

  Sums all, by_region[3];
  double peak = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    if (!valid[i]) continue;
    const vec3 r = reference.pixels[i];
    peak = std::max({peak, double(r.x), double(r.y), double(r.z)});
    Sums* sets[2] = {&all, regions[i] == Region::none ? nullptr : &by_region[int(regions[i]) - 1]};
    for (Sums* set : sets) {
      if (!set) continue;
      set->add(image.pixels[i], r);
      if (!windowed) continue;
      set->flip += double(flip[i]);
      if (!std::isnan(ssim[i])) set->ssim += double(ssim[i]), ++set->windows;
    }
  }
  const double scale = rms(reference, valid);
  ErrorReport report;
  report.all = all.finish(scale, peak, black, windowed);
  for (int k = 0; k < 3; ++k) report.region[k] = by_region[k].finish(scale, peak, black, windowed);
  return report;
}

double rms(const Image& image, const std::vector<bool>& valid) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (valid[i]) sum += glm::dot(dvec3(image.pixels[i]), dvec3(image.pixels[i])), ++count;
  return count ? std::sqrt(sum / (3.0 * double(count))) : 0.0;
}

Image difference(const Image& image, const Image& reference) {
  Image out = image;
  for (std::size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] -= reference.pixels[i];
  return out;
}

std::optional<dvec3> mean(const Image& image, const std::vector<bool>& valid) {
  dvec3 sum(0.0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (valid[i]) sum += dvec3(image.pixels[i]), ++count;
  return count ? std::optional(sum / double(count)) : std::nullopt;
}

double exposure_for(const Image& reference, const std::vector<bool>& valid, double light) {
  std::vector<float> values;
  for (std::size_t i = 0; i < reference.pixels.size(); ++i)
    if (valid[i]) values.push_back(luminance(reference.pixels[i]));
  double white = light;
  if (!values.empty()) {
    const auto at = values.begin() + std::ptrdiff_t(double(values.size() - 1) * 0.99);
    std::nth_element(values.begin(), at, values.end());
    const double crumb = 1e-12 * light, percentile = double(*at);
    const double brightest = percentile > crumb ? percentile : double(*std::max_element(at, values.end()));
    if (brightest > crumb) white = brightest;
  }
  return white > 0.0 ? 0.8 / white : 1.0;
}

std::vector<float> display_luminance(const Image& image, double exposure) {
  std::vector<float> grey;
  grey.reserve(image.pixels.size());
  for (const vec3& p : image.pixels)
    grey.push_back(srgb_encode(float(std::clamp(exposure * double(luminance(p)), 0.0, 1.0))));
  return grey;
}

std::vector<float> ssim_map(const std::vector<float>& a, const std::vector<float>& b, int width, int height) {
  constexpr int radius = 5;
  if (width < 2 * radius + 1 || height < 2 * radius + 1) return {};
  const Kernel window = gaussian_kernel(1.5, radius);
  const auto product = [](const std::vector<float>& x, const std::vector<float>& y) {
    std::vector<float> p(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) p[i] = x[i] * y[i];
    return p;
  };
  const auto mean = [&](const std::vector<float>& x) { return filter(x, width, height, window, window); };
  const auto ma = mean(a), mb = mean(b), maa = mean(product(a, a)), mbb = mean(product(b, b)),
             mab = mean(product(a, b));
  std::vector<float> map(a.size(), std::numeric_limits<float>::quiet_NaN());
  const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  for (int y = radius; y < height - radius; ++y)
    for (int x = radius; x < width - radius; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const double ua = ma[i], ub = mb[i];
      const double va = double(maa[i]) - ua * ua, vb = double(mbb[i]) - ub * ub, cov = double(mab[i]) - ua * ub;
      map[i] = float((2 * ua * ub + c1) * (2 * cov + c2) / ((ua * ua + ub * ub + c1) * (va + vb + c2)));
    }
  return map;
}

}  // namespace penumbra
