// Marks the small inline functions that scalar, SIMD and CUDA code share. To a compiler without CUDA it says nothing.
#pragma once

#ifdef __CUDACC__
#define PENUMBRA_HD __host__ __device__
#else
#define PENUMBRA_HD
#endif
