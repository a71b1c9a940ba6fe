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

/// Level-1 state of a batch: blocked pixels of every 4 x 4 block, [block][receiver], and sums of level 2.
struct Batch {
  std::vector<float> counts;
  std::uint32_t faces = 0;  ///< that have any blocked block
  vec3 level2[batch];
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

/// Adds table row x weights of one block to the three sums.
HWY_INLINE void AddBlock(const std::int8_t* row, const float* weights, VF* sum) {
  const Floats d;
  const hn::Rebind<std::int32_t, Floats> di;
  const hn::Rebind<std::int8_t, Floats> d8;
  const int lanes = int(hn::Lanes(d));
  for (int k = 0; k < 16; k += lanes) {
    const VF values = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, row + k)));
    for (int c = 0; c < 3; ++c) sum[c] = hn::MulAdd(values, hn::LoadU(d, weights + c * 16 + k), sum[c]);
  }
}

/// One receiver's blocks: counts for level 1, sums for level 2.
HWY_INLINE void TakeBlocks(const Functional& f, const Blocked& blocked, std::uint64_t active, int receiver,
                           Batch& out) {
  const Floats d;
  const haar::BinaryTable& table = haar::binary_table();
  const int n = f.n, m = n / 4, per_face = m * m;
  VF sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::uint64_t left = blocked.touched & active; left; left &= left - 1) {
    const int first = std::countr_zero(left) * texels_per_line;
    for (int texel = first; texel < first + texels_per_line; texel += 4 * n) {  // a row of blocks
      const int face = texel / (n * n), j = texel / n % n / 4;
      for (int part = 0; part < (n + 31) / 32; ++part) {  // a word's width of it
        std::uint32_t rows[4];
        for (int k = 0; k < 4; ++k) {
          const int t = texel + k * n + part * 32;
          rows[k] = blocked.words[t >> 5] >> (t & 31);
          if (n < 32) rows[k] &= (1u << n) - 1u;
        }
        if ((rows[0] | rows[1] | rows[2] | rows[3]) == 0) continue;
        std::uint32_t indices[8];
        BlockIndices(rows, indices);
        const int base = face * per_face + j * m + part * 8;
        for (int k = 0; k < std::min(8, m); ++k) {
          if (indices[k] == 0) continue;
          const std::int8_t* row = table[indices[k]];
          out.counts[std::size_t(base + k) * batch + receiver] = float(row[0]);
          out.faces |= 1u << face;
          if (indices[k] == 0xffff || f.slot[base + k] < 0) continue;  // no level 2, or nobody asks
          AddBlock(row, f.level2.data() + std::size_t(f.slot[base + k]) * 48, sum);
        }
      }
    }
  }
  out.level2[receiver] = {hn::GetLane(hn::SumOfLanes(d, sum[0])), hn::GetLane(hn::SumOfLanes(d, sum[1])),
                          hn::GetLane(hn::SumOfLanes(d, sum[2]))};
}

/// Haar transform of one face's block counts for lanes of receivers, multiplied with the weights as it goes. Counts are
/// of blocked pixels in 16ths; the coefficients of V are 1 - scale and minus the wavelets.
HWY_INLINE void TransformAndWeigh(const Functional& f, int face, int lane, float* counts, VF* sum) {
  const Floats d;
  const int m = f.n / 4, per_face = m * m;
  const float* weights[3];
  for (int c = 0; c < 3; ++c) weights[c] = f.level1[c].data() + std::size_t(face) * per_face;
  float* means = counts + std::size_t(face) * per_face * batch + lane;
  float scale = -1.0f / 16.0f;  // of sums: counts are not divided by 4 on the way up
  for (int half = m / 2; half >= 1; half /= 2) {
    // 2^-l / 4 of means, where the means of this level are sums of (m / 2 / half)^2 counts
    const float quarter = 0.25f / float(half) * scale;
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < half; ++i) {
        const auto at = [&](int y, int x) { return hn::LoadU(d, means + std::size_t(2 * half * y + x) * batch); };
        const VF a = at(2 * j, 2 * i), b = at(2 * j, 2 * i + 1), e = at(2 * j + 1, 2 * i), g = at(2 * j + 1, 2 * i + 1);
        const VF sum_top = hn::Add(a, b), sum_low = hn::Add(e, g), diff_top = hn::Sub(a, b), diff_low = hn::Sub(e, g);
        const VF by = hn::Set(d, quarter);
        const VF wavelets[3] = {hn::Mul(hn::Add(diff_top, diff_low), by), hn::Mul(hn::Sub(sum_top, sum_low), by),
                                hn::Mul(hn::Sub(diff_top, diff_low), by)};
        const int k = half * half + j * half + i;
        for (int mother = 0; mother < 3; ++mother)
          for (int c = 0; c < 3; ++c)
            sum[c] = hn::MulAdd(wavelets[mother], hn::Set(d, weights[c][k + mother * half * half]), sum[c]);
        hn::StoreU(hn::Add(sum_top, sum_low), d, means + std::size_t(j * half + i) * batch);
      }
    scale *= 0.25f;
  }
  const VF open = hn::MulAdd(hn::LoadU(d, means), hn::Set(d, scale), hn::Set(d, 1.0f));
  for (int c = 0; c < 3; ++c) sum[c] = hn::MulAdd(open, hn::Set(d, weights[c][0]), sum[c]);
}

HWY_INLINE void ShadeBatch(const Job& job, const int* which, int count, int plan, BitCube& traced, Batch& state,
                           vec3* radiance) {
  const Floats d;
  const Functional& f = (*job.functionals)[plan];
  const std::uint64_t active = (*job.active)[plan];
  const int per_face = f.n * f.n / 16;
  std::fill(state.counts.begin(), state.counts.end(), 0.0f);
  state.faces = 0;
  Blocked blocked;
  for (int r = 0; r < count; ++r) {
    FindBlocked(job.blocked, which[r], active, traced, blocked);
    TakeBlocks(f, blocked, active, r, state);
  }
  for (int lane = 0; lane < batch; lane += int(hn::Lanes(d))) {
    VF sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (int face = 0; face < 6; ++face) {
      if (state.faces >> face & 1u) {
        TransformAndWeigh(f, face, lane, state.counts.data(), sum);
      } else {  // open: scale 1, no wavelets
        for (int c = 0; c < 3; ++c) sum[c] = hn::Add(sum[c], hn::Set(d, f.level1[c][std::size_t(face) * per_face]));
      }
    }
    HWY_ALIGN float values[3][batch];
    for (int c = 0; c < 3; ++c) hn::Store(sum[c], d, values[c]);
    for (int r = lane; r < std::min(count, lane + int(hn::Lanes(d))); ++r)
      radiance[which[r]] = job.blocked.receivers->albedo[which[r]] *
                           (state.level2[r] + vec3(values[0][r - lane], values[1][r - lane], values[2][r - lane]));
  }
}

void Shade(const Job& job, int begin, int end, vec3* radiance) {
  const Receivers& receivers = *job.blocked.receivers;
  BitCube traced(job.blocked.rays ? job.blocked.cones->n : 0);
  Batch state;
  state.counts.resize(std::size_t(6) * job.blocked.cones->n * job.blocked.cones->n / 16 * batch);
  int which[batch], count = 0;
  for (int k = begin; k < end; ++k) {
    const int i = (*job.blocked.order)[k];
    if (!receivers.valid(i)) {
      radiance[i] = vec3(0.0f);
      continue;
    }
    if (count == batch || (count > 0 && (*job.plan_of)[i] != (*job.plan_of)[which[0]])) {
      ShadeBatch(job, which, count, (*job.plan_of)[which[0]], traced, state, radiance);
      count = 0;
    }
    which[count++] = i;
  }
  if (count > 0) ShadeBatch(job, which, count, (*job.plan_of)[which[0]], traced, state, radiance);
}

const char* Target() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::wavelet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::wavelet {

HWY_EXPORT(Shade);
HWY_EXPORT(Target);

void shade(const Job& job, int begin, int end, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, begin, end, radiance);
}

std::string target() {
  return HWY_DYNAMIC_DISPATCH(Target)();
}

}  // namespace penumbra::wavelet
#endif  // HWY_ONCE
