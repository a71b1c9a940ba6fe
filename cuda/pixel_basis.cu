// pixel-basis on the device: a block shades a receiver. Its warps take the words of 32 texels in turn, a lane a texel.
#include "techniques/pixel_basis/pixel_basis.h"

#include "cuda/kernels.h"
#include "cuda/visibility.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

/// A texel of the light: energy = radiance * solid angle / pi.
struct alignas(8) LightTexel {
  vec3 direction, energy;
};

/// This thread's part of the sum over open texels of (normal . w) L dw / pi. Blocked texels are skipped, not multiplied
/// by zero.
__device__ inline vec3 open_texels(const VisibilitySpans& v, const Span<const LightTexel>& light, vec3 normal,
                                   std::uint64_t active, const SharedSpan<std::uint32_t>& blocked) {
  vec3 sum(0.0f);
  for (unsigned w = threadIdx.x / warp_lanes; w < v.words(); w += receiver_warps) {
    if (!(active >> (w / words_per_line) & 1u)) continue;
    const unsigned lane = threadIdx.x % warp_lanes;
    const std::uint32_t bits = blocked[w];
    if (bits == ~0u || (bits >> lane & 1u)) continue;
    const LightTexel texel = light[w * 32 + lane];
    const float cosine = glm::dot(normal, texel.direction);
    if (cosine > 0.0f) sum += texel.energy * cosine;
    tally(12);
  }
  return sum;
}

template <From from>
__global__ void __launch_bounds__(receiver_threads)
    shade_pixels(VisibilitySpans v, ReceiverSpans receivers, Span<const LightTexel> light, Span<vec3> radiance) {
  PENUMBRA_SHARED(std::uint32_t, blocked, most_words);
  PENUMBRA_SHARED(int, entry, from == From::table ? receiver_threads : 1);
  PENUMBRA_SHARED(Cap, cap, receiver_threads);
  PENUMBRA_SHARED(std::uint64_t, touched, receiver_threads);
  PENUMBRA_SHARED(float, sums, receiver_warps);
  const std::size_t i = blockIdx.x;
  const vec3 normal = receivers.normal[i];
  if (normal == vec3(0.0f)) {
    if (threadIdx.x == 0) radiance[i] = vec3(0.0f);
    return;
  }
  const std::uint64_t active = active_lines(v, normal);
  find_blocked<from>(v, {entry, cap, touched}, receivers.position[i], active, receivers.on_occluder[i] != 0, blocked);
  __syncthreads();
  const vec3 sum = open_texels(v, light, normal, active, blocked);
  vec3 all;
  for (int c = 0; c < 3; ++c) all[c] = block_sum(sum[c], sums, receiver_warps);
  if (threadIdx.x == 0) radiance[i] = receivers.albedo[i] * all;
}

class PixelBasisOnDevice final : public OnDevice<PixelBasis> {
 public:
  explicit PixelBasisOnDevice(const Parameters& p) : OnDevice(p), visibility_on_device_(visibility_) {}

 protected:
  void upload(const Changes& changed) override {
    visibility_on_device_.upload(stream_, visibility_, changed);
    if (!changed.light) return;
    std::vector<LightTexel> texels;
    texels.reserve(std::size_t(light_.size()));
    for (int t = 0; t < light_.size(); ++t)
      texels.push_back({light_.directions[t], light_.radiance[t] * (light_.solid_angle[t] * float(1.0 / pi))});
    texels_.upload(stream_, texels);
  }

  void queue() override {
    const auto blocks = unsigned(receiver_count());
    const auto run = [&](const auto& kernel) {
      launch(stream_, kernel, blocks, receiver_threads, visibility_on_device_.spans(), receivers(), texels_.span(),
             radiance_.span());
    };
    if (visibility_on_device_.from() == From::table) run(PENUMBRA_KERNEL(shade_pixels<From::table>));
    else run(PENUMBRA_KERNEL(shade_pixels<From::raster>));
  }

  Footprint device_bytes() const override {
    Footprint bytes = visibility_on_device_.bytes();
    bytes.per_scene += texels_.bytes();
    return bytes;
  }

 private:
  DeviceVisibility visibility_on_device_;
  Buffer<LightTexel> texels_;
};

void add_pixel_basis(Makers& makers) {
  makers["pixel-basis"] = maker<PixelBasisOnDevice>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
