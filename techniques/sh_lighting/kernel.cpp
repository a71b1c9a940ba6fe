#include "techniques/sh_lighting/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/sh_lighting/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::sh_lighting {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int most_row = 36;
using Four = hn::CappedTag<float, row_multiple>;  // rows of orders 2 to 6 are 1, 3, 4, 7, 9 of these; or single floats

void AddDirections(const DirectionSet& set, vec3 normal, const std::vector<int>& chosen, float scale, float* out) {
  const Four d;
  const int lanes = int(hn::Lanes(d)), vectors = set.row / lanes;
  hn::Vec<Four> sum[most_row];
  for (int k = 0; k < vectors; ++k) sum[k] = hn::Zero(d);
  for (const int j : chosen) {
    const auto cosine = hn::Set(d, glm::dot(set.directions[j], normal));
    const float* y = &set.basis[std::size_t(j) * set.row];
    for (int k = 0; k < vectors; ++k) sum[k] = hn::MulAdd(cosine, hn::LoadU(d, y + k * lanes), sum[k]);
  }
  for (int k = 0; k < vectors; ++k)
    hn::StoreU(hn::MulAdd(hn::Set(d, scale), sum[k], hn::LoadU(d, out + k * lanes)), d, out + k * lanes);
}

void AddBounces(const DirectionSet& set, vec3 normal, const std::vector<Bounce>& bounces,
                const TransferVectors& vertices, float* out) {
  const Four d;
  const int lanes = int(hn::Lanes(d)), vectors = 3 * set.row / lanes;
  hn::Vec<Four> sum[3 * most_row];
  for (int k = 0; k < vectors; ++k) sum[k] = hn::Zero(d);
  for (const Bounce& b : bounces) {
    const float cosine = glm::dot(set.directions[b.direction], normal);
    for (int v = 0; v < 3; ++v) {
      const auto weight = hn::Set(d, cosine * b.weight[v]);
      const float* row = vertices.at(b.vertex[v]);
      for (int k = 0; k < vectors; ++k) sum[k] = hn::MulAdd(weight, hn::LoadU(d, row + k * lanes), sum[k]);
    }
  }
  for (int k = 0; k < vectors; ++k)
    hn::StoreU(hn::MulAdd(hn::Set(d, set.weight()), sum[k], hn::LoadU(d, out + k * lanes)), d, out + k * lanes);
}

void Shade(const TransferVectors& transfer, const std::array<std::vector<float>, 3>& light,
           const std::vector<vec3>& albedo, int begin, int end, vec3* radiance) {
  const Four d;
  for (int i = begin; i < end; ++i)
    for (int c = 0; c < 3; ++c) {
      const float* row = transfer.at(std::size_t(i), transfer.channels == 3 ? c : 0);
      auto sum = hn::Zero(d);
      for (int k = 0; k < transfer.row; k += int(hn::Lanes(d)))
        sum = hn::MulAdd(hn::LoadU(d, row + k), hn::LoadU(d, &light[c][k]), sum);
      radiance[i][c] = albedo[i][c] * hn::GetLane(hn::SumOfLanes(d, sum));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh_lighting
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::sh_lighting {

HWY_EXPORT(AddDirections);
HWY_EXPORT(AddBounces);
HWY_EXPORT(Shade);

void add_directions(const DirectionSet& set, vec3 normal, const std::vector<int>& chosen, float scale, float* out) {
  HWY_DYNAMIC_DISPATCH(AddDirections)(set, normal, chosen, scale, out);
}

void add_bounces(const DirectionSet& set, vec3 normal, const std::vector<Bounce>& bounces,
                 const TransferVectors& vertices, float* out) {
  HWY_DYNAMIC_DISPATCH(AddBounces)(set, normal, bounces, vertices, out);
}

void shade(const TransferVectors& transfer, const std::array<std::vector<float>, 3>& light,
           const std::vector<vec3>& albedo, int begin, int end, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(transfer, light, albedo, begin, end, radiance);
}

}  // namespace penumbra::sh_lighting
#endif  // HWY_ONCE
