// Blocked texels of one receiver, by one block (Zhao & Che 2011, section 3.3): spheres in chunks, their table entries
// or caps found by a thread each; then a thread a word, or a lane a texel, ORs them.
#pragma once

#include "cuda/on_device.h"
#include "scenes/unsupported.h"
#include "techniques/bases/visibility_source.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

enum class From { table, raster };

constexpr unsigned receiver_threads = 192;  ///< of the block that shades a receiver: a word each at n = 32
constexpr unsigned receiver_warps = receiver_threads / warp_lanes;
constexpr unsigned most_words = 768;  ///< n = 64

struct Thresholds {
  float r2[SphereTable::bins];
  __device__ float operator[](int bin) const { return r2[bin]; }
};

/// What kernels need.
struct VisibilitySpans {
  int n = 0;
  Span<const Sphere> spheres;
  Span<const vec3> directions;        ///< raster
  Span<const Cone> lines;             ///< bounds of 512 texels
  Span<const std::uint32_t> table;    ///< words of the entries
  Span<const std::uint16_t> touched;  ///< lines that an entry touches
  Thresholds thresholds;
  PENUMBRA_HD unsigned words() const { return unsigned(6 * n * n) / 32; }
};

/// Shared memory of find_blocked().
struct BlockedScratch {
  SharedSpan<int> entry;              ///< receiver_threads
  SharedSpan<Cap> cap;                ///< receiver_threads; raster
  SharedSpan<std::uint64_t> touched;  ///< receiver_threads; lines that a sphere may touch
};

/// ORs a chunk of table entries into this thread's word.
__device__ inline std::uint32_t merge_entries(const VisibilitySpans& v, const BlockedScratch& s, unsigned count,
                                              unsigned word) {
  std::uint32_t bits = 0;
  for (unsigned k = 0; k < count; ++k) {
    const int entry = s.entry[k];
    if (entry == blocks_everything) bits = ~0u;
    else if (entry != blocks_nothing && (s.touched[k] >> (word / words_per_line) & 1u))
      bits |= v.table[std::size_t(entry) * v.words() + word];
  }
  return bits;
}

/// ORs a chunk of caps into the words of this thread's warp, 32 texels at a time.
__device__ inline void merge_caps(const VisibilitySpans& v, const BlockedScratch& s, unsigned count,
                                  std::uint64_t active, const SharedSpan<std::uint32_t>& words) {
  for (unsigned w = threadIdx.x / warp_lanes; w < v.words(); w += receiver_warps) {
    const unsigned line = w / words_per_line, lane = threadIdx.x % warp_lanes;
    if (!(active >> line & 1u)) continue;
    const vec3 direction = v.directions[w * 32 + lane];
    bool blocked = false;
    for (unsigned k = 0; k < count; ++k) {
      if (!(s.touched[k] >> line & 1u)) continue;
      const Cap cap = s.cap[k];
      blocked |= covers(cap, direction);
      tally(6);
    }
    const unsigned bits = __ballot_sync(all_lanes, blocked);
    if (lane == 0) words[w] |= bits;
  }
}

/// Lines with a texel above the horizon: a lane a line. Whole warps call it.
__device__ inline std::uint64_t active_lines(const VisibilitySpans& v, vec3 normal) {
  const unsigned lines = v.words() / words_per_line, lane = threadIdx.x % warp_lanes;
  std::uint64_t active = 0;
  for (unsigned first = 0; first < lines; first += warp_lanes) {
    const bool above = first + lane < lines && above_horizon(v.lines[first + lane], normal);
    active |= std::uint64_t(__ballot_sync(all_lanes, above)) << first;
    tally(7);
  }
  return active;
}

/// Thread k of the block looks at sphere first + k.
template <From from>
__device__ void look_at_sphere(const VisibilitySpans& v, const BlockedScratch& s, vec3 x, unsigned first) {
  const unsigned k = threadIdx.x;
  if (first + k >= v.spheres.size) return;
  const Sphere sphere = v.spheres[first + k];
  tally(20);
  if constexpr (from == From::table) {
    const int entry = sphere_table_entry(v.thresholds, v.n, sphere.centre, sphere.radius, x);
    s.entry[k] = entry;
    s.touched[k] = entry >= 0 ? v.touched[std::size_t(entry)] : 0;
  } else {
    const Cap cap = make_cap(sphere.centre, sphere.radius, x);
    std::uint64_t touched = 0;
    for (unsigned line = 0; line < v.words() / words_per_line; ++line)
      if (may_cover(cap, v.lines[line])) touched |= std::uint64_t(1) << line;
    tally(float(v.words() / words_per_line * 9));
    s.cap[k] = cap;
    s.touched[k] = touched;
  }
}

/// Fills words[0 .. v.words()); 0 in lines below the horizon. All threads of the block call it, and a barrier must
/// follow before others' words are read. `on_occluder`: an object's own spheres swallow its surface.
template <From from>
__device__ void find_blocked(const VisibilitySpans& v, const BlockedScratch& s, vec3 x, std::uint64_t active,
                             bool on_occluder, const SharedSpan<std::uint32_t>& words) {
  const unsigned count = on_occluder ? 0u : unsigned(v.spheres.size), word = threadIdx.x;
  const bool looks = word < v.words() && (active >> (word / words_per_line) & 1u);
  std::uint32_t bits = 0;
  if constexpr (from == From::raster) {
    for (unsigned w = threadIdx.x / warp_lanes; w < v.words(); w += receiver_warps)
      if (threadIdx.x % warp_lanes == 0) words[w] = 0u;
  }
  for (unsigned first = 0; first < count; first += receiver_threads) {
    const unsigned chunk = count - first < receiver_threads ? count - first : receiver_threads;
    look_at_sphere<from>(v, s, x, first);
    __syncthreads();
    if constexpr (from == From::raster) merge_caps(v, s, chunk, active, words);
    else if (looks) bits |= merge_entries(v, s, chunk, word);
    __syncthreads();
  }
  if constexpr (from == From::table)
    if (word < v.words()) words[word] = bits;
}

/// The device's copy of a VisibilitySource.
class DeviceVisibility {
 public:
  /// Throws Unsupported for rays: there is no tree of triangles on the device.
  explicit DeviceVisibility(const VisibilitySource& source) {
    if (source.traces_rays())
      throw Unsupported("visibility=rays: rays are traced on the host only; use table or raster");
  }
  void upload(const Stream& stream, const VisibilitySource& source, const Changes& changed) {
    const BlockedJob job = source.job();
    spans_.n = source.resolution();
    if (!complete_) upload_tables(stream, source, job);
    if (changed.spheres) spheres_.upload(stream, source.spheres().spheres);
    spans_.spheres = spheres_.span();
  }
  From from() const { return table_.size() > 0 ? From::table : From::raster; }
  const VisibilitySpans& spans() const { return spans_; }
  Footprint bytes() const {
    return {table_.bytes() + touched_.bytes() + directions_.bytes() + lines_.bytes(), 0, spheres_.bytes()};
  }

 private:
  void upload_tables(const Stream& stream, const VisibilitySource& source, const BlockedJob& job) {
    std::vector<Cone> lines;
    for (std::size_t k = 0; k < source.cones().axis.size(); ++k) lines.push_back(source.cones().cone(k));
    lines_.upload(stream, lines);
    directions_.upload(stream, source.directions());
    if (job.table) {
      const std::size_t entries = std::size_t(6) * spans_.n * spans_.n * SphereTable::bins;
      table_.upload(stream, std::span(job.table->data(), entries * std::size_t(job.table->words())));
      touched_.upload(stream, std::span(job.table->masks(), entries));
      for (int bin = 0; bin < SphereTable::bins; ++bin) spans_.thresholds.r2[bin] = job.table->thresholds()[bin];
    }
    spans_.lines = lines_.span(), spans_.directions = directions_.span();
    spans_.table = table_.span(), spans_.touched = touched_.span();
    complete_ = true;
  }

  bool complete_ = false;  ///< the tables are there
  VisibilitySpans spans_;
  Buffer<Sphere> spheres_;
  Buffer<vec3> directions_;
  Buffer<Cone> lines_;
  Buffer<std::uint32_t> table_;
  Buffer<std::uint16_t> touched_;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
