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

/// Nine running sums (LightSums::Nine).
class Sums {
  using Tag = hn::CappedTag<float, 16>;
  static constexpr int parts = 16 / int(hn::MaxLanes(Tag()));

 public:
  HWY_INLINE Sums() {
    for (auto& part : sum_) part = hn::Zero(Tag());
  }
  HWY_INLINE void add(const LightSums::Nine& nine) {
    for (int k = 0; k < parts; ++k)
      sum_[k] = hn::Add(sum_[k], hn::Load(Tag(), nine.value + k * int(hn::MaxLanes(Tag()))));
  }
  /// Their product with a normal, by channel; light from the horizon may round to less than none.
  HWY_INLINE vec3 towards(vec3 normal) const {
    HWY_ALIGN float value[16];
    for (int k = 0; k < parts; ++k) hn::Store(sum_[k], Tag(), value + k * int(hn::MaxLanes(Tag())));
    vec3 out;
    for (int c = 0; c < 3; ++c)
      out[c] = std::max(0.0f, normal.x * value[4 * c] + normal.y * value[4 * c + 1] + normal.z * value[4 * c + 2]);
    return out;
  }

 private:
  hn::Vec<Tag> sum_[parts];
};

/// Open texels of a word. Runs that begin or end with it take one sum each; what lies between shadows is added texel by
/// texel. Everything is selected, nothing is subtracted, so a blocked sun leaves no residue.
HWY_INLINE void AddWord(const LightSums& light, int first, std::uint32_t open, Sums& sums) {
  if (open == 0) return;
  const int none = int(light.texel.size()), lead = std::countr_one(open);
  const int trail = lead == 32 ? 0 : std::countl_one(open);
  sums.add(light.up_to[lead > 0 ? first + lead - 1 : none]);
  sums.add(light.from[trail > 0 ? first + 32 - trail : none]);
  if (lead + trail == 32) return;
  for (std::uint32_t left = open & ~0u << lead & ~0u >> trail; left; left &= left - 1)
    sums.add(light.texel[first + std::countr_zero(left)]);
}

/// A line's words, hidden texels set. Runs of open words that begin or end with the line take one sum each.
HWY_INLINE void AddLine(const LightSums& light, int line, const std::uint32_t* blocked, const std::uint32_t* below,
                        Sums& sums) {
  const Words d;
  const int lanes = int(hn::Lanes(d)), none = int(light.words_up_to.size()) - 1, first = line * words_per_line;
  HWY_ALIGN std::uint32_t hidden[words_per_line];
  std::uint32_t open = 0, closed = 0;  // a bit a word
  for (int w = 0; w < words_per_line; w += lanes) {
    const auto words = hn::Or(hn::Load(d, blocked + w), hn::Load(d, below + w));
    hn::Store(words, d, hidden + w);
    std::uint8_t packed[2][8] = {};
    hn::StoreMaskBits(d, hn::Eq(words, hn::Zero(d)), packed[0]);
    hn::StoreMaskBits(d, hn::Eq(words, hn::Set(d, ~0u)), packed[1]);
    open |= (packed[0][0] | unsigned(packed[0][1]) << 8) << w;
    closed |= (packed[1][0] | unsigned(packed[1][1]) << 8) << w;
  }
  const int lead = std::countr_one(open), trail = lead == 16 ? 0 : std::countl_one(open << 16);
  sums.add(light.words_up_to[lead > 0 ? first + lead - 1 : none]);
  sums.add(light.words_from[trail > 0 ? first + 16 - trail : none]);
  for (std::uint32_t left = ~closed & 0xffffu & ~0u << lead & 0xffffu >> trail; left; left &= left - 1) {
    const int w = std::countr_zero(left);
    AddWord(light, (first + w) * 32, ~hidden[w], sums);
  }
}

HWY_INLINE vec3 SumOpen(const LightSums& light, const Horizon& horizon, const Blocked& blocked) {
  Sums sums;
  HWY_ALIGN constexpr std::uint32_t open_line[words_per_line] = {};
  for (std::uint64_t left = horizon.active; left; left &= left - 1) {
    const int line = std::countr_zero(left);
    const bool touched = blocked.touched >> line & 1u;
    if (!touched && !(horizon.cut >> line & 1u)) sums.add(light.line[line]);
    else
      AddLine(light, line, touched ? blocked.words + line * words_per_line : open_line,
              horizon.below + line * words_per_line, sums);
  }
  return sums.towards(horizon.normal);
}

void Shade(const Job& job, int begin, int end, vec3* radiance) {
  const Receivers& r = *job.blocked.receivers;
  Search search(job.blocked);
  for (int k = begin; k < end; ++k) {
    const int i = (*job.blocked.order)[k];
    if (!r.valid(i)) {
      radiance[i] = vec3(0.0f);
      continue;
    }
    search.look(i);
    radiance[i] = r.albedo[i] * SumOpen(*job.light, search.horizon, search.blocked);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pixel_basis
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pixel_basis {

HWY_EXPORT(Shade);

void shade(const Job& job, int begin, int end, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, begin, end, radiance);
}

}  // namespace penumbra::pixel_basis
#endif  // HWY_ONCE
