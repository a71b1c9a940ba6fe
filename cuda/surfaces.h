// Filters over an image of binary visibility, on the device: visibility_filter::SurfaceBits and what is done with them.
#pragma once

#include <optional>

#include "cuda/kernel.h"
#include "techniques/visibility_filter/adaptive.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

class DeviceSurfaces {
 public:
  using Rows = visibility_filter::SurfaceRows<Span<std::uint64_t>>;

  void resize(const Stream& stream, int width, int height);
  /// What the rays found, of as many pixels.
  void upload(const Stream& stream, const visibility_filter::PixelMap& map);

  /// Queue the kernels that fill visibility(). `to_eye` is empty where there is no eye.
  void queue_filter(const Stream& stream, const visibility_filter::Filtering& how, Span<const float> to_eye);
  void queue_box(const Stream& stream, int r);

  Span<const float> visibility() const { return visibility_.span(); }
  std::size_t bytes() const {
    return words_.bytes() + depth_.bytes() + caster_.bytes() + radius_.bytes() + visibility_.bytes();
  }

 private:
  unsigned blocks_of_words(unsigned threads_a_word = 1) const;
  void queue_mixed(const Stream& stream, int r);

  Rows rows_;
  Buffer<std::uint64_t> words_;
  Buffer<float> depth_, caster_, visibility_;
  Buffer<std::uint8_t> radius_;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
