#include "techniques/ray_traced_denoised/surface.h"

#include <algorithm>
#include <cmath>

#include "techniques/bases/for_ranges.h"

namespace penumbra::ray_traced_denoised {
namespace {

constexpr float most_sine = 0.25f;    // 14 degrees off a tangent plane
constexpr float least_cosine = 0.9f;  // 26 degrees between normals
constexpr float longest_leap = 4.0f;  // of the distances before and after

/// Is pixel k + 1 of a row much farther from pixel k than they are from those beside them? What lies in one plane may
/// be seen directly by the one and in a mirror by the other.
bool leaps(const Receivers& r, int first, int count, int step, int k) {
  const auto distance = [&](int a, int b) {
    const int i = first + a * step, j = first + b * step;
    return a < 0 || b >= count || !r.valid(i) || !r.valid(j) ? 0.0f : glm::distance(r.position[i], r.position[j]);
  };
  const float beside = std::max(distance(k - 1, k), distance(k + 1, k + 2));
  return beside > 0.0f && distance(k, k + 1) > longest_leap * beside;
}

/// Runs and density of `count` pixels, `step` apart, from `first` on.
void walk(const Receivers& r, int first, int count, int step, std::uint8_t* before, std::uint8_t* after,
          float* density) {
  before[first] = 0;
  float chord = 0.0f;  // to the pixel before; 0 if it is not linked
  for (int k = 0, i = first; k < count; ++k, i += step) {
    const bool on = k + 1 < count && linked(r, i, i + step) && !leaps(r, first, count, step, k);
    const float next = on ? glm::distance(r.position[i], r.position[i + step]) : 0.0f;
    const float links = float(chord > 0.0f) + float(next > 0.0f);
    density[i] = links > 0.0f ? links / (chord + next) : 0.0f;
    if (k + 1 < count) before[i + step] = on ? std::uint8_t(std::min(longest_run, before[i] + 1)) : std::uint8_t(0);
    chord = next;
  }
  std::uint8_t run = 0;
  for (int k = count - 1, i = first + k * step; k >= 0; --k, i -= step) {
    after[i] = run;
    run = before[i] > 0 ? std::uint8_t(std::min(longest_run, run + 1)) : std::uint8_t(0);
  }
}

}  // namespace

bool linked(const Receivers& receivers, int a, int b) {
  if (!receivers.valid(a) || !receivers.valid(b)) return false;
  const vec3 m = receivers.normal[a], n = receivers.normal[b], chord = receivers.position[b] - receivers.position[a];
  const float most = most_sine * glm::length(chord);
  return std::abs(glm::dot(m, chord)) <= most && std::abs(glm::dot(n, chord)) <= most && glm::dot(m, n) >= least_cosine;
}

void find_surfaces(const Receivers& receivers, SurfaceMap& map) {
  map.width = receivers.width, map.height = receivers.height;
  const std::size_t n = std::size_t(receivers.size()) + SurfaceMap::padding;
  for (auto* run : {&map.left, &map.right, &map.up, &map.down}) run->assign(n, 0);
  for (auto* density : {&map.across, &map.along}) density->assign(n, 0.0f);
  if (map.height < 2) return;
  for_ranges(map.height, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      walk(receivers, y * map.width, map.width, 1, map.left.data(), map.right.data(), map.across.data());
  });
  for_ranges(map.width, 64, [&](int begin, int end) {
    for (int x = begin; x < end; ++x)
      walk(receivers, x, map.height, map.width, map.up.data(), map.down.data(), map.along.data());
  });
}

}  // namespace penumbra::ray_traced_denoised
