#include "techniques/pixel_basis/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pixel_basis/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/blocked-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pixel_basis {
namespace HWY_NAMESPACE {
using namespace penumbra::HWY_NAMESPACE;  // NOLINT: the bases of the same instruction set
namespace hn = hwy::HWY_NAMESPACE;

// --- sums over open texels -------------------------------------------------------------------------------------------

/// Adds the open texels of one word with weights known per texel.
HWY_INLINE void AddWord(const std::vector<float>* weights, int t, std::uint32_t bits, VF* sum) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  std::uint8_t bytes[12] = {};
  for (int k = 0; k < 32; k += lanes) {
    const std::uint32_t part = bits >> k;
    std::memcpy(bytes, &part, sizeof part);
    const auto blocked = hn::LoadMaskBits(d, bytes);
    for (int c = 0; c < 3; ++c) sum[c] = hn::Add(sum[c], hn::IfThenZeroElse(blocked, hn::LoadU(d, &weights[c][t + k])));
  }
}

/// Open words and lines take their sums, mixed words are added texel by texel: everything is selected, nothing is
/// subtracted, so a blocked sun leaves no residue.
HWY_INLINE vec3 SumWeights(const NormalWeights& weights, const Blocked& blocked) {
  const Floats d;
  const Words dw;
  const int lanes = int(hn::Lanes(dw));
  VF sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  vec3 open(0.0f);
  for (std::uint64_t left = weights.active; left; left &= left - 1) {
    const int line = std::countr_zero(left);
    if (!(blocked.touched >> line & 1u)) {
      open += weights.line[line];
      continue;
    }
    for (int w = line * words_per_line; w < (line + 1) * words_per_line; w += lanes) {
      const auto words = hn::Load(dw, blocked.words + w);
      const auto untouched = hn::Eq(words, hn::Zero(dw));
      for (int c = 0; c < 3; ++c)
        sum[c] = hn::Add(sum[c], hn::IfThenElseZero(hn::RebindMask(d, untouched), hn::LoadU(d, &weights.word[c][w])));
      if (hn::AllTrue(dw, untouched)) continue;
      for (int k = w; k < w + lanes; ++k)
        if (const std::uint32_t bits = blocked.words[k]; bits != 0 && bits != ~0u)
          AddWord(weights.texel, k * 32, bits, sum);
    }
  }
  vec3 total = open;
  for (int c = 0; c < 3; ++c) total[c] += hn::GetLane(hn::SumOfLanes(d, sum[c]));
  return total;
}

/// The same for a normal of its own: the cosine is evaluated for every open texel.
HWY_INLINE vec3 SumCosine(const LightEnergy& light, const LineCones& cones, vec3 normal, std::uint64_t active,
                          const Blocked& blocked) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF nx = hn::Set(d, normal.x), ny = hn::Set(d, normal.y), nz = hn::Set(d, normal.z), zero = hn::Zero(d);
  VF sum[3] = {zero, zero, zero};
  std::uint8_t bytes[12] = {};
  for (std::uint64_t left = active; left; left &= left - 1) {
    const int line = std::countr_zero(left);
    const bool open = !(blocked.touched >> line & 1u);
    for (int w = line * words_per_line; w < (line + 1) * words_per_line; ++w) {
      const std::uint32_t bits = open ? 0u : blocked.words[w];
      if (bits == ~0u) continue;
      for (int k = 0; k < 32; k += lanes) {
        const int t = w * 32 + k;
        const VF dot = hn::Add(hn::Add(hn::Mul(nx, hn::LoadU(d, &cones.direction[0][t])),
                                       hn::Mul(ny, hn::LoadU(d, &cones.direction[1][t]))),
                               hn::Mul(nz, hn::LoadU(d, &cones.direction[2][t])));
        const std::uint32_t part = bits >> k;
        std::memcpy(bytes, &part, sizeof part);
        const VF cosine = hn::IfThenZeroElse(hn::LoadMaskBits(d, bytes), hn::Max(dot, zero));
        for (int c = 0; c < 3; ++c)
          sum[c] = hn::Add(
              sum[c], hn::IfThenElseZero(hn::Gt(cosine, zero), hn::Mul(cosine, hn::LoadU(d, &light.channel[c][t]))));
      }
    }
  }
  return {hn::GetLane(hn::SumOfLanes(d, sum[0])), hn::GetLane(hn::SumOfLanes(d, sum[1])),
          hn::GetLane(hn::SumOfLanes(d, sum[2]))};
}

void Shade(const Job& job, int begin, int end, vec3* radiance) {
  const Receivers& r = *job.blocked.receivers;
  Blocked blocked;
  BitCube traced(job.blocked.rays ? job.blocked.cones->n : 0);
  for (int k = begin; k < end; ++k) {
    const int i = (*job.blocked.order)[k];
    if (!r.valid(i)) {
      radiance[i] = vec3(0.0f);
      continue;
    }
    const NormalWeights* weights = job.weights->empty() ? nullptr : &(*job.weights)[(*job.weight_of)[i]];
    const std::uint64_t active = weights ? weights->active : lines_above_horizon(*job.blocked.cones, r.normal[i]);
    FindBlocked(job.blocked, i, active, traced, blocked);
    radiance[i] = r.albedo[i] * (weights ? SumWeights(*weights, blocked)
                                         : SumCosine(*job.light, *job.blocked.cones, r.normal[i], active, blocked));
  }
}

const char* Target() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pixel_basis
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pixel_basis {

HWY_EXPORT(Shade);
HWY_EXPORT(Target);

void shade(const Job& job, int begin, int end, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, begin, end, radiance);
}

std::string target() {
  return HWY_DYNAMIC_DISPATCH(Target)();
}

}  // namespace penumbra::pixel_basis
#endif  // HWY_ONCE
