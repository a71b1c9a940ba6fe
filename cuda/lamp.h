// What all techniques under a lamp do alike on the device: unshadowed radiance in closed form, and radiance = albedo *
// unshadowed radiance * visibility. The host's stages, its rays among them, come before the device's.
#pragma once

#include "cuda/on_device.h"
#include "techniques/bases/area_irradiance.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

constexpr unsigned threads = 128;

// Static: every file of kernels that is about lamps has its own.

static __global__ void __launch_bounds__(threads)
    light_receivers(LampOutline lamp, ReceiverSpans receivers, Span<float> factor) {
  const std::size_t i = global_thread();
  if (i >= factor.size) return;
  factor[i] = receivers.valid(i) ? form_factor(lamp, receivers.position[i], receivers.normal[i]) : 0.0f;
  tally(float(60 * (lamp.radius > 0.0f ? 1 : lamp.count)));
}

static __global__ void __launch_bounds__(threads)
    compose(ReceiverSpans receivers, Span<const float> unshadowed, Span<const float> visibility, vec3 emitted,
            Span<vec3> radiance) {
  const std::size_t i = global_thread();
  if (i < radiance.size) radiance[i] = receivers.albedo[i] * (unshadowed[i] * visibility[i] * emitted);
  tally(7);
}

/// Adds these kernels to a technique that has a lamp_ and what it has emitted_.
template <class Scalar>
class UnderLamp : public OnDevice<Scalar> {
 public:
  using OnDevice<Scalar>::OnDevice;

  std::vector<Stage> stages() const override {
    // NOLINTNEXTLINE(bugprone-parent-virtual-call): both are wanted
    std::vector<Stage> all = Scalar::stages(), device = OnDevice<Scalar>::stages();
    all.insert(all.end(), device.begin(), device.end());
    return all;
  }

 protected:
  unsigned blocks_of_receivers() const { return blocks_for(this->receiver_count(), threads); }

  /// For upload(), when lamp or receivers change.
  void queue_light() {
    unshadowed_on_device_.resize(this->receiver_count());
    launch(this->stream_, PENUMBRA_KERNEL(light_receivers), blocks_of_receivers(), threads, this->lamp_,
           this->receivers(), unshadowed_on_device_.span());
  }
  void queue_compose(Span<const float> visibility) {
    launch(this->stream_, PENUMBRA_KERNEL(compose), blocks_of_receivers(), threads, this->receivers(),
           unshadowed_on_device_.span(), visibility, this->emitted_, this->radiance_.span());
  }
  std::size_t light_bytes() const { return unshadowed_on_device_.bytes(); }

 private:
  Buffer<float> unshadowed_on_device_;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
