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
HWY_INLINE Blockers TexelSums(const ShadowMap& map, int left, int right, int top, int bottom, float limit) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF far = hn::Set(d, limit);
  VF sum[vectors], ones[vectors];
  const VF one = hn::Set(d, 1.0f);
  for (int v = 0; v < vectors; ++v) sum[v] = ones[v] = hn::Zero(d);
  for (int y = top; y < bottom; ++y) {
    const float* row = &map.depth[map.index(0, y)];
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
  const int rows = std::max(1, 4096 / (right - left));  // of floats that are added up before a double takes over
  double count = 0.0, depth_sum = 0.0;
  for (int y = top; y < bottom; y += rows) {
    const Blockers part = WithVectors([&](auto vectors) HWY_ATTR {
      return TexelSums<vectors()>(map, left, right, y, y + rows < bottom ? y + rows : bottom, d);
    });
    count += double(part.count), depth_sum += double(part.depth_sum);
  }
  return {float(count), float(depth_sum)};
}

// --- squares of the multi-scale map ----------------------------------------------------------------------------------

// Four numbers whatever the instruction set: a square has four quarters. They are fetched one by one, which on several
// processors is twice as fast as a gather, into the compiler's own vectors: these stay in registers.
typedef float Quad __attribute__((vector_size(16)));
typedef std::int32_t QuadMask __attribute__((vector_size(16)));

/// Bit k is set where the mask's number k is not 0.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE unsigned Bits(QuadMask mask) {
  return unsigned((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}
#else
HWY_INLINE unsigned Bits(hn::Mask<hn::Full128<float> > mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(hn::Full128<float>(), mask, bytes);
  return bytes[0];
}
HWY_INLINE unsigned Bits(QuadMask mask) {
  return Bits(hn::MaskFromVec(hn::LoadU(hn::Full128<float>(), reinterpret_cast<const float*>(&mask))));
}
#endif

/// Sums over the quadtree of one region, depth first.
template <bool depths>
class Quadtree {
 public:
  HWY_INLINE Quadtree(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples, float limit,
                      int leaf_level, Sum how)
      : map_(map), levels_(levels), samples_(samples), limit_(limit), leaf_level_(leaf_level), how_(how) {}

  /// `root`: undecided, above leaf_level.
  HWY_INLINE Blockers Add(const Square& root) {
    Square open[4 * 16];  // at most three squares wait on each level
    int count = 0;
    open[count++] = root;
    while (count > 0) {
      const Square node = open[--count];
      const int level = node.level - 1, half = 1 << level;
      const std::size_t at = levels_.index(node.left, node.top, level);
      const std::size_t down = std::size_t(half) * std::size_t(levels_.stride(level));
      const std::size_t quarter[4] = {at, at + std::size_t(half), at + down, at + down + std::size_t(half)};
      unsigned whole, some;
      Look(quarter, whole, some);
      AddWhole(quarter, whole, float(half) * float(half));
      const Square child[4] = {{node.left, node.top, level},
                               {node.left + half, node.top, level},
                               {node.left, node.top + half, level},
                               {node.left + half, node.top + half, level}};
      for (unsigned k = 0; k < 4; ++k) {  // a list without branches: only undecided ones advance its end
        open[count] = child[k];
        count += int(some >> k & 1u);
      }
      if (level == leaf_level_)
        for (; some != 0; some &= some - 1) AddLeaf(open[--count]);
    }
    return found_;
  }

  HWY_INLINE void AddLeaf(const Square& leaf) {
    const Blockers inside = how_ == Sum::nearest ? nearest_leaf(leaf, {levels_.low(leaf), 0.0f}) : Sampled(leaf);
    found_.count += inside.count, found_.depth_sum += inside.depth_sum;
  }
  Blockers found() const { return found_; }

 private:
  /// Which of four squares block as a whole, and which are undecided.
  HWY_INLINE void Look(const std::size_t* square, unsigned& whole, unsigned& some) const {
    const float* bounds = levels_.bounds();
#if HWY_TARGET == HWY_SCALAR
    Quad low, high;
    for (int k = 0; k < 4; ++k) low[k] = bounds[2 * square[k]], high[k] = bounds[2 * square[k] + 1];
    whole = Bits(high > -limit_);  // high is negated
    some = Bits(low < limit_) & ~whole;
#else
    const hn::Full128<float> d;
    const hn::Full64<float> pair;  // the two bounds of a square as they lie
    const auto a = hn::Combine(d, hn::LoadU(pair, bounds + 2 * square[1]), hn::LoadU(pair, bounds + 2 * square[0]));
    const auto b = hn::Combine(d, hn::LoadU(pair, bounds + 2 * square[3]), hn::LoadU(pair, bounds + 2 * square[2]));
    whole = Bits(hn::Gt(hn::ConcatOdd(d, b, a), hn::Set(d, -limit_)));  // high is negated
    some = Bits(hn::Lt(hn::ConcatEven(d, b, a), hn::Set(d, limit_))) & ~whole;
#endif
  }

  HWY_INLINE void AddWhole(const std::size_t* square, unsigned whole, float texels) {
    found_.count += texels * float(std::popcount(whole));
    if constexpr (depths)
      for (; whole != 0; whole &= whole - 1)
        found_.depth_sum += texels * levels_.means()[square[std::countr_zero(whole)]];
  }

  HWY_INLINE Blockers Sampled(const Square& leaf) const {
    const int edge = leaf.edge(), count = SampleImage::count(edge);
    const std::int32_t* offset = samples_.of(leaf.level, (leaf.left + leaf.top + edge) % SampleImage::variants);
    const float* corner = &map_.depth[map_.index(leaf.left, leaf.top)];
    const float scale = float(edge * edge) / float(count);
    if (count < 4) return corner[*offset] < limit_ ? Blockers{scale, scale * corner[*offset]} : Blockers{};
    int hits = 0;
    Quad sum = {};
    for (int k = 0; k < count; k += 4) {
      const Quad z = {corner[offset[k]], corner[offset[k + 1]], corner[offset[k + 2]], corner[offset[k + 3]]};
      const QuadMask closer = z < limit_;
      hits += std::popcount(Bits(closer));
      if constexpr (depths) sum += Quad(closer & QuadMask(z));
    }
    return {scale * float(hits), depths ? scale * ((sum[0] + sum[1]) + (sum[2] + sum[3])) : 0.0f};
  }

  const ShadowMap& map_;
  const MultiScaleMap& levels_;
  const LeafSamples& samples_;
  const float limit_;
  const int leaf_level_;
  const Sum how_;
  Blockers found_;
};

template <bool depths>
HWY_INLINE Blockers SumSquare(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples,
                              const Square& square, int depth, float d, Sum how) {
  const DepthRange range = levels.range(square);
  const auto texels = float(square.edge() * square.edge());
  if (range.high < d) return {texels, depths ? texels * levels.mean(square) : 0.0f};
  if (!(range.low < d)) return {};
  const int leaf_level = square.level > depth ? square.level - depth : 0;
  Quadtree<depths> tree(map, levels, samples, d, leaf_level, how);
  if (square.level > leaf_level) return tree.Add(square);
  tree.AddLeaf(square);
  return tree.found();
}

Blockers BlockersOfSquare(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples,
                          const Square& square, int depth, float d, Sum how, bool depths) {
  return depths ? SumSquare<true>(map, levels, samples, square, depth, d, how)
                : SumSquare<false>(map, levels, samples, square, depth, d, how);
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

HWY_EXPORT(BlockersOfTexels);
HWY_EXPORT(BlockersOfSquare);
HWY_EXPORT(BlurRows);
HWY_EXPORT(BlurColumns);

Blockers blockers_of_texels(const ShadowMap& map, const Texels& texels, float d) {
  return HWY_DYNAMIC_DISPATCH(BlockersOfTexels)(map, texels, d);
}
Blockers blockers_of_square(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples,
                            const Square& square, int depth, float d, Sum how, bool depths) {
  return HWY_DYNAMIC_DISPATCH(BlockersOfSquare)(map, levels, samples, square, depth, d, how, depths);
}
void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out) {
  HWY_DYNAMIC_DISPATCH(BlurRows)(in, kernel, begin, end, out);
}
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out) {
  HWY_DYNAMIC_DISPATCH(BlurColumns)(in, kernel, begin, end, out);
}

}  // namespace penumbra::pcss::simd
#endif  // HWY_ONCE
