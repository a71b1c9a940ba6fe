#include "techniques/pcss/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pcss/region_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sums run over groups of 16: entry j of a group is always added to partial sum j, so that they do not depend on how
// many lanes an instruction set has.
constexpr int group = 16;
using Floats = hn::CappedTag<float, group>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;

struct GroupSum {
  alignas(64) float part[group] = {};
  float total() const {
    float sum[group];
    std::copy_n(part, group, sum);
    for (int half = group / 2; half > 0; half /= 2)
      for (int j = 0; j < half; ++j) sum[j] += sum[j + half];
    return sum[0];
  }
};

// --- texels of a region ----------------------------------------------------------------------------------------------

template <int vectors>
HWY_INLINE Blockers TexelSums(const float* depth, int stride, int left, int right, int top, int bottom, float limit) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF far = hn::Set(d, limit);
  VF sum[vectors], ones[vectors];
  const VF one = hn::Set(d, 1.0f);
  for (int v = 0; v < vectors; ++v) sum[v] = ones[v] = hn::Zero(d);
  for (int y = top; y < bottom; ++y) {
    const float* row = depth + std::size_t(y) * stride;
    int x = left;
    for (; x + group <= right; x += group)
      for (int v = 0; v < vectors; ++v) {
        const VF z = hn::LoadU(d, row + x + v * lanes);
        const auto closer = hn::Lt(z, far);
        sum[v] = hn::Add(sum[v], hn::IfThenElseZero(closer, z));
        ones[v] = hn::Add(ones[v], hn::IfThenElseZero(closer, one));
      }
    for (int v = 0; v < vectors && x + v * lanes < right; ++v) {
      const VF z = hn::LoadU(d, row + x + v * lanes);
      const auto closer = hn::And(hn::Lt(z, far), hn::FirstN(d, std::size_t(right - x - v * lanes)));
      sum[v] = hn::Add(sum[v], hn::IfThenElseZero(closer, z));
      ones[v] = hn::Add(ones[v], hn::IfThenElseZero(closer, one));
    }
  }
  GroupSum sums, counts;
  for (int v = 0; v < vectors; ++v)
    hn::Store(sum[v], d, sums.part + v * lanes), hn::Store(ones[v], d, counts.part + v * lanes);
  return {counts.total(), sums.total()};
}

/// Calls use(constant) with the number of vectors in a group.
template <class Use>
HWY_INLINE auto WithVectors(const Use& use) {
  const int lanes = int(hn::Lanes(Floats()));
  if (lanes == 16) return use(std::integral_constant<int, 1>());
  if (lanes == 8) return use(std::integral_constant<int, 2>());
  if (lanes == 4) return use(std::integral_constant<int, 4>());
  return use(std::integral_constant<int, 16>());
}

Blockers BlockersOfTexels(const ShadowMap& map, const Texels& t, float d) {
  const int n = map.resolution();
  const int left = t.left > 0 ? t.left : 0, right = t.right < n ? t.right : n;
  const int top = t.top > 0 ? t.top : 0, bottom = t.bottom < n ? t.bottom : n;
  if (left >= right || top >= bottom) return {};
  return WithVectors(
      [&](auto vectors) { return TexelSums<vectors()>(map.depth.data(), n, left, right, top, bottom, d); });
}

// --- squares of the multi-scale map ----------------------------------------------------------------------------------

/// Samples of one leaf: how many block, and their depths into `sum`.
HWY_INLINE int SampleLeaf(const float* corner, const std::int32_t* offsets, int count, float limit, GroupSum& sum) {
  const Floats d;
  const Ints di;
  const int lanes = int(hn::Lanes(d));
  int hits = 0;
  for (int j = 0; j < count; j += lanes) {
    const VF z = hn::GatherIndex(d, corner, hn::LoadU(di, offsets + j));
    auto closer = hn::Lt(z, hn::Set(d, limit));
    if (count - j < lanes) closer = hn::And(closer, hn::FirstN(d, std::size_t(count - j)));
    hits += int(hn::CountTrue(d, closer));
    hn::Store(hn::Add(hn::Load(d, sum.part + j), hn::IfThenElseZero(closer, z)), d, sum.part + j);
  }
  return hits;
}

struct LeafSums {
  int whole = 0;    ///< leaves that block, or count as if
  int samples = 0;  ///< samples that block
  GroupSum mean, sampled;
};

/// Looks at a group of leaves, numbers first to first + 15 of size x size in row order.
struct LeafGrid {
  const MultiScaleMap& map;
  const SampleOffsets& offsets;
  const Square square;
  const int leaf_level, log_size;
  const float limit;
  const Sum how;

  HWY_INLINE void Add(int first, LeafSums& sums) const {
    const Floats d;
    const Ints di;
    const int lanes = int(hn::Lanes(d)), size = 1 << log_size, leaves = size * size;
    const std::size_t base = map.index(square.left, square.top, leaf_level);
    const VF far = hn::Set(d, limit);
    for (int j = 0; j < group && first + j < leaves; j += lanes) {
      const VI k = hn::Min(hn::Iota(di, first + j), hn::Set(di, leaves - 1));
      const VI row = hn::Shr(k, hn::Set(di, log_size)), column = hn::And(k, hn::Set(di, size - 1));
      const VI at =
          hn::Shl(hn::Add(hn::Mul(row, hn::Set(di, map.stride(leaf_level))), column), hn::Set(di, leaf_level));
      auto there = hn::FirstN(d, std::size_t(leaves - first - j));
      const VF low = hn::GatherIndex(d, map.low() + base, at), high = hn::GatherIndex(d, map.high() + base, at);
      const auto whole = hn::And(there, hn::Lt(high, far));
      const auto some = hn::And(there, hn::AndNot(whole, hn::Lt(low, far)));
      sums.whole += int(hn::CountTrue(d, whole));
      VF mean = hn::Load(d, sums.mean.part + j);
      if (!hn::AllFalse(d, whole))
        mean = hn::Add(mean, hn::IfThenElseZero(whole, hn::GatherIndex(d, map.mean() + base, at)));
      if (!hn::AllFalse(d, some)) {
        if (how == Sum::nearest) {
          sums.whole += int(hn::CountTrue(d, some));
          mean = hn::Add(mean, hn::IfThenElseZero(some, low));
        } else {
          AddSamples(first + j, some, sums);
        }
      }
      hn::Store(mean, d, sums.mean.part + j);
    }
  }

  HWY_INLINE void AddSamples(int first, hn::Mask<Floats> some, LeafSums& sums) const {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Floats(), some, bytes);
    unsigned bits = bytes[0] | unsigned(bytes[1]) << 8;
    const int edge = 1 << leaf_level, mask = (1 << log_size) - 1, count = SampleImage::count(edge);
    for (; bits != 0; bits &= bits - 1) {
      const int k = first + std::countr_zero(bits);
      const int left = square.left + ((k & mask) << leaf_level), top = square.top + ((k >> log_size) << leaf_level);
      const int variant = (left + top + edge) % SampleImage::variants;
      sums.samples += SampleLeaf(map.low() + std::size_t(top) * map.edge() + left, offsets.of(leaf_level, variant),
                                 count, limit, sums.sampled);
    }
  }
};

Blockers BlockersOfSquare(const MultiScaleMap& map, const SampleOffsets& offsets, const Square& square, int depth,
                          float d, Sum how) {
  const DepthRange range = map.range(square);
  const auto texels = float(square.edge() * square.edge());
  if (range.high < d) return {texels, texels * range.mean};
  if (!(range.low < d)) return {};
  const int leaf_level = square.level > depth ? square.level - depth : 0, log_size = square.level - leaf_level;
  const LeafGrid grid{map, offsets, square, leaf_level, log_size, d, how};
  LeafSums sums;
  for (int first = 0; first < 1 << (2 * log_size); first += group) grid.Add(first, sums);
  const int edge = 1 << leaf_level;
  const float each = float(edge * edge), scale = each / float(SampleImage::count(edge));
  return {each * float(sums.whole) + scale * float(sums.samples),
          each * sums.mean.total() + (sums.samples > 0 ? scale * sums.sampled.total() : 0.0f)};
}

// --- blur ------------------------------------------------------------------------------------------------------------

/// Sums under the kernel at distance `step` between taps, for the `count` values from `at` on.
HWY_INLINE void BlurRun(const float* value, const float* weight, const std::vector<float>& kernel, int from, int to,
                        std::ptrdiff_t step, bool weighted, VF& sum, VF& total) {
  const Floats d;
  sum = total = hn::Zero(d);
  for (int k = from; k <= to; ++k) {
    VF w = hn::Set(d, kernel[std::size_t(k < 0 ? -k : k)]);
    const VF mask = hn::LoadU(d, weight + k * step), v = hn::LoadU(d, value + k * step);
    if (weighted) {
      w = hn::Mul(w, mask);
      sum = hn::Add(sum, hn::Mul(w, v));
      total = hn::Add(total, w);
    } else {
      sum = hn::Add(sum, hn::Mul(w, v));
      total = hn::Add(total, hn::Mul(w, mask));
    }
  }
}

void BlurRows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out) {
  const Floats d;
  const int radius = int(kernel.size()) - 1, lanes = int(hn::Lanes(d));
  for (int y = begin; y < end; ++y) {
    const std::size_t row = std::size_t(y) * in.width;
    int x = radius;
    for (; x + lanes + radius <= in.width; x += lanes) {
      VF sum, total;
      BlurRun(&in.value[row + x], &in.weight[row + x], kernel, -radius, radius, 1, true, sum, total);
      hn::StoreU(sum, d, &out.value[row + x]);
      hn::StoreU(total, d, &out.weight[row + x]);
    }
    penumbra::pcss::blur_part(in, kernel, y, 0, std::min(radius, in.width), out);
    penumbra::pcss::blur_part(in, kernel, y, std::min(x, in.width), in.width, out);
  }
}

void BlurColumns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out) {
  const Floats d;
  const int radius = int(kernel.size()) - 1, lanes = int(hn::Lanes(d));
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int y = begin; y < end; ++y) {
    const std::size_t row = std::size_t(y) * in.width;
    const int from = std::max(-radius, -y), to = std::min(radius, in.height - 1 - y);
    int x = 0;
    for (; x + lanes <= in.width; x += lanes) {
      VF sum, total;
      BlurRun(&in.value[row + x], &in.weight[row + x], kernel, from, to, in.width, false, sum, total);
      const auto some = hn::Gt(total, zero);
      hn::StoreU(hn::IfThenElse(some, hn::Div(sum, hn::IfThenElse(some, total, one)), one), d, out + row + x);
    }
    penumbra::pcss::blur_column_part(in, kernel, y, x, in.width, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pcss::simd {

SampleOffsets::SampleOffsets(const SampleImage& image, int map_edge) : map_edge_(map_edge) {
  for (int level = 0; level <= largest_level(map_edge); ++level)
    for (int variant = 0; variant < SampleImage::variants; ++variant) {
      const int edge = 1 << level, count = SampleImage::count(edge), first = SampleImage::first(edge);
      for (int k = 0; k < 16; ++k) {
        const vec2 at = image.position[variant][first + k % count] * float(edge);
        offset_.push_back(int(at.y) * map_edge + int(at.x));
      }
    }
}

HWY_EXPORT(BlockersOfTexels);
HWY_EXPORT(BlockersOfSquare);
HWY_EXPORT(BlurRows);
HWY_EXPORT(BlurColumns);

Blockers blockers_of_texels(const ShadowMap& map, const Texels& texels, float d) {
  return HWY_DYNAMIC_DISPATCH(BlockersOfTexels)(map, texels, d);
}
Blockers blockers_of_square(const MultiScaleMap& map, const SampleOffsets& samples, const Square& square, int depth,
                            float d, Sum how) {
  return HWY_DYNAMIC_DISPATCH(BlockersOfSquare)(map, samples, square, depth, d, how);
}
void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out) {
  HWY_DYNAMIC_DISPATCH(BlurRows)(in, kernel, begin, end, out);
}
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out) {
  HWY_DYNAMIC_DISPATCH(BlurColumns)(in, kernel, begin, end, out);
}

}  // namespace penumbra::pcss::simd
#endif  // HWY_ONCE
