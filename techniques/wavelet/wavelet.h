// Wavelet shadows: Zhao & Che 2011, and what its algebra allows beyond.
#pragma once

namespace penumbra {

class Registry;

/// wavelet:         the paper's pipeline, sparse asymmetric triple product
/// wavelet-product: light x BRDF merged per normal, one sparse inner product with V
/// wavelet-dense:   all terms
void register_wavelet(Registry& registry);

}  // namespace penumbra
