#include "techniques/wavelet/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/wavelet/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/blocked-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::wavelet {
namespace HWY_NAMESPACE {
using namespace penumbra::HWY_NAMESPACE;  // NOLINT: the bases of the same instruction set
namespace hn = hwy::HWY_NAMESPACE;

constexpr int batch = 16;  // receivers whose level 1 is transformed side by side
using Eight = hn::CappedTag<std::uint32_t, 8>;

/// Level-1 state of a batch: blocked pixels of every 4 x 4 block, [block][receiver], and sums of level 2 by channel.
struct Batch {
  std::vector<float> counts;
  std::uint32_t faces = 0;  ///< that have any blocked block
  float level2[9][batch];
};

/// The table indices of the eight blocks that lie under one word's width: nibble k of four row words.
HWY_INLINE void BlockIndices(const std::uint32_t* rows, std::uint32_t* indices) {
  const Eight d;
  const int lanes = int(hn::Lanes(d));
  const auto low = hn::Set(d, 15u);
  for (int k = 0; k < 8; k += lanes) {
    const auto shift = hn::Iota(d, std::uint32_t(k));
    const auto by = hn::ShiftLeft<2>(shift);
    auto index = hn::And(hn::Shr(hn::Set(d, rows[0]), by), low);
    index = hn::Or(index, hn::ShiftLeft<4>(hn::And(hn::Shr(hn::Set(d, rows[1]), by), low)));
    index = hn::Or(index, hn::ShiftLeft<8>(hn::And(hn::Shr(hn::Set(d, rows[2]), by), low)));
    index = hn::Or(index, hn::ShiftLeft<12>(hn::And(hn::Shr(hn::Set(d, rows[3]), by), low)));
    hn::StoreU(index, d, indices + k);
  }
}

/// Adds table row x weights of one block to the channels' sums.
template <int channels>
HWY_INLINE void AddBlock(const std::int8_t* row, const float* weights, VF* sum) {
  const Floats d;
  const hn::Rebind<std::int32_t, Floats> di;
  const hn::Rebind<std::int8_t, Floats> d8;
  const int lanes = int(hn::Lanes(d));
  for (int k = 0; k < 16; k += lanes) {
    const VF values = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, row + k)));
    for (int c = 0; c < channels; ++c) sum[c] = hn::MulAdd(values, hn::LoadU(d, weights + c * 16 + k), sum[c]);
  }
}

/// One receiver's blocks: counts for level 1, sums for level 2.
template <int channels>
HWY_INLINE void TakeBlocks(const Functional& f, const Blocked& blocked, std::uint64_t active, int receiver,
                           Batch& out) {
  const Floats d;
  const haar::BinaryTable& table = haar::binary_table();
  const int n = f.n, m = n / 4, per_face = m * m;
  const std::uint32_t whole = n < 32 ? (1u << n) - 1u : ~0u;
  VF sum[channels];
  for (VF& s : sum) s = hn::Zero(d);
  for (std::uint64_t left = blocked.touched & active; left; left &= left - 1) {
    const int first = std::countr_zero(left) * texels_per_line;
    for (int texel = first; texel < first + texels_per_line; texel += 4 * n) {  // a row of blocks
      const int face = texel / (n * n), j = texel / n % n / 4;
      for (int part = 0; part < (n + 31) / 32; ++part) {  // a word's width of it
        std::uint32_t rows[4];
        for (int k = 0; k < 4; ++k) {
          const int t = texel + k * n + part * 32;
          rows[k] = blocked.words[t >> 5] >> (t & 31);
          rows[k] &= whole;
        }
        if ((rows[0] | rows[1] | rows[2] | rows[3]) == 0) continue;
        const int base = face * per_face + j * m + part * 8;
        if ((rows[0] & rows[1] & rows[2] & rows[3]) == whole) {
          out.faces |= 1u << face;
          for (int k = 0; k < std::min(8, m); ++k) out.counts[std::size_t(base + k) * batch + receiver] = 16.0f;
          continue;
        }
        std::uint32_t indices[8];
        BlockIndices(rows, indices);
        for (int k = 0; k < std::min(8, m); ++k) {
          if (indices[k] == 0) continue;
          const std::int8_t* row = table[indices[k]];
          out.counts[std::size_t(base + k) * batch + receiver] = float(row[0]);
          out.faces |= 1u << face;
          if (indices[k] == 0xffff || f.slot[base + k] < 0) continue;  // no level 2, or nobody asks
          AddBlock<channels>(row, f.level2.data() + std::size_t(f.slot[base + k]) * channels * 16, sum);
        }
      }
    }
  }
  for (int c = 0; c < channels; ++c) out.level2[c][receiver] = hn::GetLane(hn::SumOfLanes(d, sum[c]));
}

/// Haar transform of one face's block counts for lanes of receivers, multiplied with the weights as it goes. Counts are
/// of blocked pixels in 16ths; the coefficients of V are 1 - scale and minus the wavelets.
template <int channels>
HWY_INLINE void TransformAndWeigh(const Functional& f, int face, int lane, float* counts, VF* sum) {
  const Floats d;
  const int m = f.n / 4, per_face = m * m;
  const float* weights[channels];
  for (int c = 0; c < channels; ++c) weights[c] = f.level1[c].data() + std::size_t(face) * per_face;
  float* means = counts + std::size_t(face) * per_face * batch + lane;
  float scale = -1.0f / 16.0f;  // of sums: counts are not divided by 4 on the way up
  for (int half = m / 2; half >= 1; half /= 2) {
    // 2^-l / 4 of means, where the means of this level are sums of (m / 2 / half)^2 counts
    const float quarter = 0.25f / float(half) * scale;
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < half; ++i) {
        const auto at = [&](int y, int x)
                            HWY_ATTR { return hn::LoadU(d, means + std::size_t(2 * half * y + x) * batch); };
        const VF a = at(2 * j, 2 * i), b = at(2 * j, 2 * i + 1), e = at(2 * j + 1, 2 * i), g = at(2 * j + 1, 2 * i + 1);
        const VF sum_top = hn::Add(a, b), sum_low = hn::Add(e, g), diff_top = hn::Sub(a, b), diff_low = hn::Sub(e, g);
        const VF by = hn::Set(d, quarter);
        const VF wavelets[3] = {hn::Mul(hn::Add(diff_top, diff_low), by), hn::Mul(hn::Sub(sum_top, sum_low), by),
                                hn::Mul(hn::Sub(diff_top, diff_low), by)};
        const int k = half * half + j * half + i;
        for (int mother = 0; mother < 3; ++mother)
          for (int c = 0; c < channels; ++c)
            sum[c] = hn::MulAdd(wavelets[mother], hn::Set(d, weights[c][k + mother * half * half]), sum[c]);
        hn::StoreU(hn::Add(sum_top, sum_low), d, means + std::size_t(j * half + i) * batch);
      }
    scale *= 0.25f;
  }
  const VF open = hn::MulAdd(hn::LoadU(d, means), hn::Set(d, scale), hn::Set(d, 1.0f));
  for (int c = 0; c < channels; ++c) sum[c] = hn::MulAdd(open, hn::Set(d, weights[c][0]), sum[c]);
}

/// Level 1 of the lanes from `lane` on: value[channel][lane].
template <int channels>
HWY_INLINE void SumLevel1(const Functional& f, int lane, Batch& state, float (*value)[batch]) {
  const Floats d;
  const int per_face = f.n * f.n / 16;
  VF sum[channels];
  for (VF& s : sum) s = hn::Zero(d);
  for (int face = 0; face < 6; ++face) {
    if (state.faces >> face & 1u) {
      TransformAndWeigh<channels>(f, face, lane, state.counts.data(), sum);
    } else {  // open: scale 1, no wavelets
      for (int c = 0; c < channels; ++c)
        sum[c] = hn::Add(sum[c], hn::Set(d, f.level1[c][std::size_t(face) * per_face]));
    }
  }
  for (int c = 0; c < channels; ++c) hn::StoreU(sum[c], d, value[c] + lane);
}

/// Receivers that share a functional: of three channels for a normal, of nine for any.
template <int channels>
HWY_INLINE void ShadeBatch(const Job& job, const int* which, int count, int plan, Search& search, Batch& state,
                           vec3* radiance) {
  const Receivers& receivers = *job.blocked.receivers;
  const Functional& f = (*job.functionals)[plan];
  std::fill(state.counts.begin(), state.counts.end(), 0.0f);
  state.faces = 0;
  for (int r = 0; r < count; ++r) {
    if (channels == 9) search.look(which[r]), search.hide_below();
    else search.look(which[r], (*job.active)[plan]);
    TakeBlocks<channels>(f, search.blocked, channels == 9 ? ~std::uint64_t(0) : (*job.active)[plan], r, state);
  }
  HWY_ALIGN float value[channels][batch];
  for (int lane = 0; lane < batch; lane += int(hn::Lanes(Floats()))) SumLevel1<channels>(f, lane, state, value);
  for (int r = 0; r < count; ++r) {
    vec3 sum(0.0f);
    for (int c = 0; c < channels; ++c) {
      const float v = state.level2[c][r] + value[c][r];
      if (channels == 9) sum[c / 3] += receivers.normal[which[r]][c % 3] * v;
      else sum[c] = v;
    }
    radiance[which[r]] = receivers.albedo[which[r]] * sum;
  }
}

void Shade(const Job& job, int begin, int end, vec3* radiance) {
  const Receivers& receivers = *job.blocked.receivers;
  Search search(job.blocked);
  Batch state;
  state.counts.resize(std::size_t(6) * job.blocked.cones->n * job.blocked.cones->n / 16 * batch);
  int which[batch], count = 0;
  const auto plan_of = [&](int i) { return job.active ? int((*job.plan_of)[i]) : 0; };
  const auto shade_batch = [&]() HWY_ATTR {
    if (count == 0) return;
    if (job.active) ShadeBatch<3>(job, which, count, plan_of(which[0]), search, state, radiance);
    else ShadeBatch<9>(job, which, count, 0, search, state, radiance);
    count = 0;
  };
  for (int k = begin; k < end; ++k) {
    const int i = (*job.blocked.order)[k];
    if (!receivers.valid(i)) {
      radiance[i] = vec3(0.0f);
      continue;
    }
    if (count == batch || (count > 0 && plan_of(i) != plan_of(which[0]))) shade_batch();
    which[count++] = i;
  }
  shade_batch();
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::wavelet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::wavelet {

HWY_EXPORT(Shade);

void shade(const Job& job, int begin, int end, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, begin, end, radiance);
}

}  // namespace penumbra::wavelet
#endif  // HWY_ONCE
