// sh-lighting on the device: the transfer of shadowed and unshadowed receivers is projected there, from rays that the
// host traced (a bit a direction); shading is a thread a receiver. Interreflected transfer comes from the host whole.
#include "techniques/sh_lighting/sh_lighting.h"

#include "cuda/kernels.h"
#include "cuda/on_device.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using sh_lighting::Estimator;
using sh_lighting::Transfer;

constexpr unsigned project_threads = 128, project_warps = project_threads / warp_lanes, shade_threads = 256;
constexpr int most_coefficients = 36;

/// M directions and the basis in each, as DirectionSet.
struct DirectionSpans {
  Span<const vec3> directions;
  Span<const float> basis;  ///< [direction][row]
  int row;
};

/// By band, what Y_lm(N) is multiplied by to make the cosine lobe about N, over pi; 0 if there is none.
struct LobeFactors {
  float band[6] = {};
};

/// T_k = lobe_k(N) + scale * sum of cos_j Y_k(w_j) over the directions above the horizon whose bit is `which`: a block
/// a receiver, first + the block's number. Transfer lies as [coefficient][receiver].
template <int order>
__global__ void __launch_bounds__(project_threads)
    project_transfer(DirectionSpans set, ReceiverSpans receivers, Span<const std::uint32_t> blocked, bool which,
                     float scale, LobeFactors lobe, std::size_t first, Span<float> transfer) {
  constexpr int size = order * order;
  PENUMBRA_SHARED(float, sums, project_warps* size);
  const std::size_t i = first + blockIdx.x, count = receivers.normal.size;
  const unsigned words = unsigned(set.directions.size + 31) / 32, warp = threadIdx.x / warp_lanes,
                 lane = threadIdx.x % warp_lanes;
  const vec3 normal = receivers.normal[i];
  if (normal == vec3(0.0f)) {
    if (threadIdx.x < unsigned(size)) transfer[threadIdx.x * count + i] = 0.0f;
    return;
  }
  float sum[size] = {};
  for (unsigned w = warp; w < words; w += project_warps) {
    const std::uint32_t bits = blocked.size > 0 ? blocked[blockIdx.x * std::size_t(words) + w] : 0u;
    const unsigned j = w * 32 + lane;
    if (j >= set.directions.size || (bits >> lane & 1u) != unsigned(which)) continue;
    const float cosine = glm::dot(set.directions[j], normal);
    if (!(cosine > 0.0f)) continue;
    PENUMBRA_UNROLL
    for (int k = 0; k < size; ++k) sum[k] += cosine * set.basis[j * unsigned(set.row) + unsigned(k)];
    tally(5 + 2 * size);
  }
  PENUMBRA_UNROLL
  for (int k = 0; k < size; ++k) {
    const float all = warp_sum(sum[k]);
    if (lane == 0) sums[warp * size + unsigned(k)] = all;
  }
  __syncthreads();
  if (threadIdx.x >= unsigned(size)) return;
  const int k = int(threadIdx.x);
  float y[size];
  sh::evaluate<order>(normal, y);
  float all = 0.0f, own = 0.0f;
  for (unsigned w = 0; w < project_warps; ++w) all += sums[w * size + threadIdx.x];
  PENUMBRA_UNROLL
  for (int c = 0; c < size; ++c)  // an index that the compiler knows keeps y in registers
    if (c == k) own = lobe.band[sh::band(c)] * y[c];
  transfer[unsigned(k) * count + i] = own + scale * all;
}

struct LightRows {
  float channel[3][most_coefficients];
};

/// B = albedo * sum of L_k T_k: a thread a receiver. `channels`: 1, or 3 where the mesh has reflected colours.
__global__ void __launch_bounds__(shade_threads)
    shade_transfer(LightRows light, int coefficients, int channels, Span<const float> transfer, ReceiverSpans receivers,
                   Span<vec3> radiance) {
  const std::size_t i = global_thread(), count = radiance.size;
  if (i >= count) return;
  vec3 sum(0.0f);
  for (int k = 0; k < coefficients; ++k)
    for (int c = 0; c < 3; ++c)
      sum[c] += light.channel[c][k] * transfer[unsigned(channels == 3 ? c * coefficients + k : k) * count + i];
  tally(float(6 * coefficients + 3));
  radiance[i] = receivers.albedo[i] * sum;
}

class ShLightingOnDevice final : public OnDevice<sh_lighting::ShLighting> {
 public:
  explicit ShLightingOnDevice(const Parameters& p) : OnDevice(p, true) {}

 protected:
  /// On the host only where light bounces.
  void set_transfer(const Mesh& mesh, const Receivers& receivers) override {
    receivers_ = &receivers;
    if (bounces()) ShLighting::set_transfer(mesh, receivers);
  }

  void upload(const Changes& changed) override {
    if (basis_.size() == 0) {
      directions_.upload(stream_, set_->directions);
      basis_.upload(stream_, set_->basis);
    }
    if (changed.mesh || changed.receivers) {
      transfer_on_device_.resize(receiver_count() * std::size_t(order_ * order_) * (bounces() ? 3 : 1));
      if (bounces()) upload_transfer();
      else sh::with_order<2, 6>(order_, [&](auto order) { project<order>(); });
    }
  }

  void queue() override {
    LightRows light = {};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < order_ * order_; ++k) light.channel[c][k] = light_[c][k];
    launch(stream_, PENUMBRA_KERNEL(shade_transfer), blocks_for(receiver_count(), shade_threads), shade_threads, light,
           order_ * order_, bounces() ? 3 : 1, transfer_on_device_.span(), receivers(), radiance_.span());
  }

  Footprint device_bytes() const override {
    return {directions_.bytes() + basis_.bytes(), transfer_on_device_.bytes() + blocked_.bytes(), 0};
  }

 private:
  bool bounces() const { return request_.transfer == Transfer::interreflected; }

  /// Rows of the host to [channel][coefficient][receiver].
  void upload_transfer() {
    const std::size_t count = receiver_count(), size = std::size_t(order_) * std::size_t(order_);
    std::vector<float> values(3 * size * count);
    for (std::size_t i = 0; i < count; ++i)
      for (int c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < size; ++k)
          values[(std::size_t(c) * size + k) * count + i] = transfer_.at(i, transfer_.channels == 3 ? c : 0)[k];
    transfer_on_device_.upload(stream_, values);
  }

  template <int order>
  void project() {
    const bool complement = request_.estimator == Estimator::complement;
    const bool traces = request_.transfer == Transfer::shadowed;
    LobeFactors lobe;
    if (complement) {
      const sh::Zonal zonal = sh::cosine_lobe(order);
      for (int l = 0; l < order; ++l) lobe.band[l] = float(std::sqrt(4.0 * pi / (2.0 * l + 1.0)) * zonal[l] / pi);
    }
    const float scale = complement ? -set_->weight() : set_->weight();
    const std::size_t words = words_of(*set_), count = receiver_count();
    const std::size_t chunk = std::max<std::size_t>(1, (std::size_t(64) << 20) / (words * sizeof(std::uint32_t)));
    for (std::size_t first = 0; first < count; first += chunk) {
      const std::size_t end = std::min(count, first + chunk);
      if (traces) blocked_.upload(stream_, blocked_directions(*set_, rays_, *receivers_, int(first), int(end)));
      launch(stream_, PENUMBRA_KERNEL(project_transfer<order>), unsigned(end - first), project_threads,
             DirectionSpans{directions_.span(), basis_.span(), set_->row}, receivers(), blocked_.span(), complement,
             scale, lobe, first, transfer_on_device_.span());
    }
  }

  Buffer<vec3> directions_;
  Buffer<float> basis_, transfer_on_device_;
  Buffer<std::uint32_t> blocked_;
};

void add_sh_lighting(Makers& makers) {
  makers["sh-lighting"] = maker<ShLightingOnDevice>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
