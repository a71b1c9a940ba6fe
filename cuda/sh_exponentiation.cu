// sh-exponentiation on the device, a thread a receiver, in three kernels: add the spheres' logarithms, exponentiate,
// shade. Coefficients pass between them as [coefficient][place]; places are receivers in the order of their clusters.
#include "techniques/sh_exponentiation/sh_exponentiation.h"

#include "cuda/kernels.h"
#include "cuda/on_device.h"
#include "scenes/cube_map.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using sh_exponentiation::Exponential;
using sh_exponentiation::LogTable;
using sh_exponentiation::optimal_linear;
using sh_exponentiation::shadow_of;
using sh_exponentiation::WeightedSphere;

constexpr unsigned threads = 128;
constexpr float root_4pi = 3.5449077018110318f;

/// Receivers by place, and the spheres that stand for the occluder there.
struct PlaceSpans {
  struct Range {
    unsigned begin, end;
  };
  Span<const int> receiver;
  Span<const Range> spheres;
  Span<const WeightedSphere> all;
};

/// Calls f(band, coefficient) for all coefficients, with numbers that the compiler knows.
template <int order, class F>
__device__ void for_bands(const F& f) {
  PENUMBRA_UNROLL
  for (int l = 0; l < order; ++l) {
    PENUMBRA_UNROLL
    for (int k = 0; k < order * order; ++k)
      if (l * l <= k && k < (l + 1) * (l + 1)) f(l, k);
  }
}

/// f += logarithm of the visibility behind one sphere.
template <int order>
__device__ void add_logarithm(const Span<const float>& rows, const WeightedSphere& sphere,
                              const sh_exponentiation::Shadow& shadow, float* f) {
  float y[order * order];
  sh::evaluate<order>(shadow.axis, y);
  const float at = (1.0f - shadow.cosine) * float(LogTable::samples - 1);
  const int last = LogTable::samples - 2, row = at > 0.0f ? (int(at) < last ? int(at) : last) : 0;
  float zonal[order];
  PENUMBRA_UNROLL
  for (int l = 0; l < order; ++l) {
    const float low = rows[unsigned(row * order + l)], high = rows[unsigned((row + 1) * order + l)];
    zonal[l] = shadow.share * sphere.weight[l] * (low + (at - float(row)) * (high - low));
  }
  for_bands<order>([&](int l, int k) { f[k] += zonal[l] * y[k]; });
  tally(30 + 6 * order + 4 * order * order);
}

// Occupancy of accumulate_logarithms: the sum of logarithms and the basis at one axis stay in registers, as in
// exponentiate.
template <int order>
__global__ void __launch_bounds__(threads)
    accumulate_logarithms(PlaceSpans places, ReceiverSpans receivers, Span<const float> rows, bool replace,
                          Span<float> logarithms) {
  const std::size_t place = global_thread(), count = places.receiver.size;
  if (place >= count) return;
  const auto i = std::size_t(places.receiver[place]);
  const vec3 x = receivers.position[i], normal = receivers.normal[i];
  const bool own = receivers.on_occluder[i] != 0;
  const PlaceSpans::Range range = places.spheres[place];
  float f[order * order] = {};
  for (unsigned s = range.begin; s < range.end; ++s) {
    const WeightedSphere& sphere = places.all[s];
    const auto shadow = shadow_of(sphere.sphere, x, normal, own, replace && !sphere.bound);
    tally(25);
    if (shadow.share != 0.0f) add_logarithm<order>(rows, sphere, shadow, f);
  }
  PENUMBRA_UNROLL
  for (int k = 0; k < order * order; ++k) logarithms[unsigned(k) * count + place] = f[k];
}

/// LinearFit on the device.
struct FitSpans {
  float step;
  Span<const float> a, b;
  __device__ float look_up_a(float norm) const {
    return sh_exponentiation::look_up_linear(a, int(a.size), norm / step);
  }
  __device__ float look_up_b(float norm) const {
    return sh_exponentiation::look_up_linear(b, int(b.size), norm / step);
  }
};

/// exp*(f) = exp*(f / 2^p)^(2^p): halved until |f| <= tau, optimal linear, squared back. tau infinite: no halving.
template <int order>
__device__ void hybrid(const FitSpans& fit, float tau, float dc, float* f) {
  constexpr int size = order * order;
  float squared_norm = 0.0f, scale = 1.0f, g[size];
  PENUMBRA_UNROLL
  for (int k = 1; k < size; ++k) squared_norm += f[k] * f[k];
  int squarings = 0;
  for (float norm = std::sqrt(squared_norm); norm > tau && norm < 1e30f; norm *= 0.5f) ++squarings, scale *= 0.5f;
  PENUMBRA_UNROLL
  for (int k = 1; k < size; ++k) f[k] *= scale;
  optimal_linear(fit, f, size, dc * scale, f);
  for (int s = 0; s < squarings; ++s) {
    sh::square<order>(f, g);
    PENUMBRA_UNROLL
    for (int k = 0; k < size; ++k) f[k] = g[k];
    tally(float(size * size));
  }
}

/// g <- (1 + f (1 + f / 2 (1 + ... f / terms))) g, every power of f multiplied from the left.
template <int order>
__device__ void series(const float* f, int terms, float* g) {
  constexpr int size = order * order;
  float sum[size], next[size];
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) sum[k] = g[k];
  for (int term = terms; term >= 1; --term) {
    sh::product<order>(f, sum, next);
    PENUMBRA_UNROLL
    for (int k = 0; k < size; ++k) sum[k] = next[k] / float(term) + g[k];
    tally(float(2 * size * size));
  }
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) g[k] = sum[k];
}

/// exp(M) 1 = exp(M / s) ... exp(M / s) 1. Exact: |M / s| <= 1, where ten terms are exact to rounding; else s = 1.
template <int order>
__device__ void by_powers(bool exact, int terms, float dc, float* f) {
  constexpr int size = order * order;
  int steps = 1;
  if (exact) {
    float bound = 0.0f, squares[order] = {};  // bound: of |f(w)| for every w, and so of |M_f|
    for_bands<order>([&](int l, int k) { squares[l] += l > 0 ? f[k] * f[k] : 0.0f; });
    PENUMBRA_UNROLL
    for (int l = 1; l < order; ++l) bound += std::sqrt(squares[l] * float((2 * l + 1) / (4 * pi)));
    steps = bound < 1e4f ? int(bound) + 1 : 1;
  }
  const float share = 1.0f / float(steps), e = std::exp(dc * share);
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) f[k] *= share;
  float g[size] = {};
  g[0] = root_4pi;
  for (int step = 0; step < steps; ++step) {
    series<order>(f, exact ? 10 : terms, g);
    PENUMBRA_UNROLL
    for (int k = 0; k < size; ++k) g[k] *= e;
  }
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) f[k] = g[k];
}

/// Visibility from its logarithm, in place. `powers`: by a power series, else by the linear fit.
// Occupancy of exponentiate: a function and its square, or function, power and product, stay in registers; arithmetic
// in independent chains hides its own latency, and shared memory in their place would be read for every operation.
template <int order, bool powers>
__global__ void __launch_bounds__(threads)
    exponentiate(bool exact, int terms, float tau, FitSpans fit, std::size_t count, Span<float> values) {
  const std::size_t place = global_thread();
  if (place >= count) return;
  constexpr int size = order * order;
  float f[size];
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) f[k] = values[unsigned(k) * count + place];
  const float dc = f[0] / root_4pi;
  f[0] = 0.0f;
  if constexpr (powers) by_powers<order>(exact, terms, dc, f);
  else hybrid<order>(fit, tau, dc, f);
  tally(float(6 * size));
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) values[unsigned(k) * count + place] = f[k];
}

/// Light by channel, and what makes the cosine lobe of Y(N), by band.
struct ReflectionRows {
  float light[3][36], lobe[6];
};

/// radiance[c] = L_c . (visibility * lobe) at albedo 1, and what would arrive without an occluder.
template <int order>
__device__ void reflect(const ReflectionRows& rows, vec3 normal, const float* visibility, vec3& radiance,
                        vec3& unshadowed) {
  constexpr int size = order * order;
  float lobe[size], reflected[size];
  sh::evaluate<order>(normal, lobe);
  for_bands<order>([&](int l, int k) { lobe[k] *= rows.lobe[l]; });
  sh::product<order>(visibility, lobe, reflected);
  radiance = unshadowed = vec3(0.0f);
  PENUMBRA_UNROLL
  for (int c = 0; c < 3; ++c) PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) {
    radiance[c] += rows.light[c][k] * reflected[k];
    unshadowed[c] += rows.light[c][k] * lobe[k];
  }
  tally(float(2 * size * size + 13 * size));
}

/// The same through the table of L * H over normals.
template <int order>
__device__ void reflect_by_table(const Span<const float>& by_normal, vec3 normal, const float* visibility,
                                 vec3& radiance, vec3& unshadowed) {
  constexpr int size = order * order;
  const auto texel = unsigned(cube_texel(normal, sh_exponentiation::normal_texels));
  radiance = vec3(0.0f);
  PENUMBRA_UNROLL
  for (unsigned c = 0; c < 3; ++c) {
    PENUMBRA_UNROLL
    for (int k = 0; k < size; ++k) radiance[int(c)] += by_normal[(texel * 3 + c) * size + unsigned(k)] * visibility[k];
    unshadowed[int(c)] = by_normal[(texel * 3 + c) * size] * root_4pi;
  }
  tally(float(6 * size));
}

/// counts: values that were not finite, and values that were clamped.
// Occupancy of shade_visibility: the product of visibility and cosine lobe stays in registers, as in exponentiate.
template <int order>
__global__ void __launch_bounds__(threads)
    shade_visibility(PlaceSpans places, ReceiverSpans receivers, Span<const float> values, ReflectionRows rows,
                     Span<const float> by_normal, Span<unsigned> counts, Span<vec3> radiance) {
  const std::size_t place = global_thread(), count = places.receiver.size;
  if (place >= count) return;
  const auto i = std::size_t(places.receiver[place]);
  float visibility[order * order];
  PENUMBRA_UNROLL
  for (int k = 0; k < order * order; ++k) visibility[k] = values[unsigned(k) * count + place];
  vec3 value, unshadowed, out;
  if (by_normal.size > 0) reflect_by_table<order>(by_normal, receivers.normal[i], visibility, value, unshadowed);
  else reflect<order>(rows, receivers.normal[i], visibility, value, unshadowed);
  unsigned non_finite = 0, clamped = 0;
  PENUMBRA_UNROLL
  for (int c = 0; c < 3; ++c)
    out[c] =
        sh_exponentiation::guarded(value[c] * float(1.0 / pi), unshadowed[c] * float(1.0 / pi), non_finite, clamped);
  if (non_finite > 0) atomic_add(counts, 0, non_finite);
  if (clamped > 0) atomic_add(counts, 1, clamped);
  radiance[i] = receivers.albedo[i] * out;
}

__global__ void clear_counts(Span<unsigned> counts) {
  if (threadIdx.x < counts.size) counts[threadIdx.x] = 0;
}

class ShExponentiationOnDevice final : public OnDevice<sh_exponentiation::ShExponentiation> {
 public:
  using OnDevice::OnDevice;

  std::map<std::string, std::size_t> counters() const override {
    unsigned found[2] = {};
    if (counts_on_device_.size() == 2) counts_on_device_.download(stream_, found);
    counts_.non_finite = found[0], counts_.clamped = found[1];
    return OnDevice::counters();
  }

 protected:
  void upload(const Changes& changed) override {
    if (counts_on_device_.size() == 0) {
      rows_.upload(stream_, job_.table->rows());
      fit_a_.upload(stream_, job_.fit->a), fit_b_.upload(stream_, job_.fit->b);
      counts_on_device_.upload(stream_, std::vector<unsigned>(2, 0u));
    }
    if (changed.receivers)  // what shows nothing is in no cluster, and stays black
      radiance_.upload(stream_, std::vector<vec3>(receiver_count(), vec3(0.0f)));
    if (changed.receivers || changed.spheres) upload_places();
    if (changed.light) by_normal_.upload(stream_, table_normals_ ? job_.by_normal : std::vector<float>());
  }

  void queue() override {
    sh::with_order<4, 6>(order_, [&](auto order) { queue_order<order>(); });
  }

  Footprint device_bytes() const override {
    return {rows_.bytes() + fit_a_.bytes() + fit_b_.bytes(),
            receiver_.bytes() + range_.bytes() + by_normal_.bytes() + counts_on_device_.bytes(),
            spheres_.bytes() + values_.bytes()};
  }

 private:
  void upload_places() {
    std::vector<int> receiver;
    std::vector<PlaceSpans::Range> range;
    std::vector<WeightedSphere> spheres;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      const auto list = spheres_of(k);
      const auto first = unsigned(spheres.size());
      spheres.insert(spheres.end(), list.begin(), list.end());
      receiver.insert(receiver.end(), clusters_[k].receivers.begin(), clusters_[k].receivers.end());
      range.resize(receiver.size(), {first, unsigned(spheres.size())});
    }
    receiver_.upload(stream_, receiver), range_.upload(stream_, range), spheres_.upload(stream_, spheres);
    values_.resize(receiver.size() * std::size_t(order_ * order_));
  }

  template <int order>
  void queue_order() {
    const PlaceSpans places{receiver_.span(), range_.span(), spheres_.span()};
    const unsigned blocks = blocks_for(receiver_.size(), threads);
    const FitSpans fit{float(job_.fit->step), fit_a_.span(), fit_b_.span()};
    const Exponential kind = job_.method.kind;
    const bool exact = kind == Exponential::exact;
    const float tau = kind == Exponential::hybrid ? float(job_.method.tau) : std::numeric_limits<float>::infinity();
    ReflectionRows rows = {};
    for (int c = 0; c < 3; ++c) std::copy(job_.light[c].begin(), job_.light[c].end(), rows.light[c]);
    std::copy(job_.lobe.begin(), job_.lobe.end(), rows.lobe);

    launch(stream_, PENUMBRA_KERNEL(clear_counts), 1, warp_lanes, counts_on_device_.span());
    launch(stream_, PENUMBRA_KERNEL(accumulate_logarithms<order>), blocks, threads, places, receivers(), rows_.span(),
           job_.replace, values_.span());
    const auto exponential = [&](const auto& kernel) {
      launch(stream_, kernel, blocks, threads, exact, job_.method.terms, tau, fit, receiver_.size(), values_.span());
    };
    if (exact || kind == Exponential::power_series) exponential(PENUMBRA_KERNEL((exponentiate<order, true>)));
    else exponential(PENUMBRA_KERNEL((exponentiate<order, false>)));
    launch(stream_, PENUMBRA_KERNEL(shade_visibility<order>), blocks, threads, places, receivers(), values_.span(),
           rows, by_normal_.span(), counts_on_device_.span(), radiance_.span());
  }

  Buffer<float> rows_, fit_a_, fit_b_, by_normal_, values_;
  Buffer<int> receiver_;
  Buffer<PlaceSpans::Range> range_;
  Buffer<WeightedSphere> spheres_;
  Buffer<unsigned> counts_on_device_;
};

void add_sh_exponentiation(Makers& makers) {
  makers["sh-exponentiation"] = maker<ShExponentiationOnDevice>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
