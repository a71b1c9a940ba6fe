// Blocked texels of one receiver, by one block (Zhao & Che 2011, section 3.3): spheres in chunks, their table entries
// or caps found by a thread each; then a thread a word ORs them.
#pragma once

#include "cuda/on_device.h"
#include "scenes/unsupported.h"
#include "techniques/bases/cap_rows.h"
#include "techniques/bases/visibility_source.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

enum class From { table, raster };

constexpr unsigned receiver_threads = 192;  ///< of the block that shades a receiver: a word each at n = 32
constexpr unsigned receiver_warps = receiver_threads / warp_lanes;
constexpr unsigned most_words = 768;  ///< n = 64

struct Thresholds {
  float r2[SphereTable::published_bins];
  __device__ float operator[](int bin) const { return r2[bin]; }
};

/// What kernels need to find blocked texels.
struct VisibilitySpans {
  int n = 0;
  Span<const Sphere> spheres;
  Span<const vec3> directions;      ///< raster
  Span<const Cone> lines;           ///< bounds of 512 texels
  Span<const std::uint32_t> table;  ///< words of the entries
  Span<const TableEntry> entries;
  BinsOf<Thresholds> bins{};
  int edge = 0;  ///< of the table's directions
  PENUMBRA_HD unsigned words() const { return unsigned(6 * n * n) / 32; }
};

/// Shared memory of find_blocked().
struct BlockedScratch {
  SharedSpan<int> entry;              ///< receiver_threads; TableEntry::first, or beyond_table: look at the cap
  SharedSpan<Cap> cap;                ///< receiver_threads
  SharedSpan<std::uint64_t> touched;  ///< receiver_threads; lines that a sphere may touch
};

/// How many bits are set.
__device__ inline unsigned bits_in(std::uint32_t x) {
  x -= x >> 1 & 0x55555555u;
  x = (x & 0x33333333u) + (x >> 2 & 0x33333333u);
  return ((x + (x >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
}

/// What an entry of the table blocks of a word, which lies in one of its lines.
__device__ inline std::uint32_t entry_word(const VisibilitySpans& v, const TableEntry& entry, unsigned word) {
  const unsigned before = bits_in(entry.lines & ((1u << (word / words_per_line)) - 1u));
  return v.table[(std::size_t(entry.first) + before) * words_per_line + word % words_per_line];
}

/// What a cap covers of a row's columns [from, from + count), the first of which is texel `first`.
__device__ inline std::uint32_t row_bits(const VisibilitySpans& v, const Cap& cap, unsigned first, int from,
                                         int count) {
  const unsigned n = unsigned(v.n), row = first / n;
  tally(24);
  const ColumnRange columns = columns_of(on_face(cap, int(row / n)), cube_centre(int(row % n), v.n), v.n);
  std::uint32_t bits = 0;
  if (columns.unsure) {
    for (int k = 0; k < count; ++k) bits |= std::uint32_t(covers(cap, v.directions[first + unsigned(k)])) << k;
    tally(float(6 * count));
    return bits;
  }
  const int begin = columns.first > from ? columns.first - from : 0;
  const int end = columns.end - from < count ? columns.end - from : count;
  return begin < end ? ~0u << begin & ~0u >> (32 - end) : 0u;
}

/// What a cap covers of a word: half a row, a row, or two.
__device__ inline std::uint32_t cap_word(const VisibilitySpans& v, const Cap& cap, unsigned word) {
  const int n = v.n;
  if (n >= 32) return row_bits(v, cap, word * 32, int(word * 32 % unsigned(n)), 32);
  return row_bits(v, cap, word * 32, 0, n) | row_bits(v, cap, word * 32 + unsigned(n), 0, n) << n;
}

/// What a chunk of spheres blocks of a word.
template <From from>
__device__ std::uint32_t merge_word(const VisibilitySpans& v, const BlockedScratch& s, unsigned count, unsigned word) {
  std::uint32_t bits = 0;
  for (unsigned k = 0; k < count; ++k) {
    const std::uint64_t touched = s.touched[k];
    if (!(touched >> (word / words_per_line) & 1u)) continue;
    if constexpr (from == From::table) {
      if (const int entry = s.entry[k]; entry != beyond_table) {
        bits |= entry == blocks_everything ? ~0u : entry_word(v, {std::uint32_t(entry), std::uint32_t(touched)}, word);
        continue;
      }
    }
    const Cap cap = s.cap[k];
    bits |= cap.cosine < -1.0f ? ~0u : cap_word(v, cap, word);
  }
  return bits;
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

/// Lines that a cap may cover.
__device__ inline std::uint64_t lines_of_cap(const VisibilitySpans& v, const Cap& cap) {
  const unsigned lines = v.words() / words_per_line;
  std::uint64_t touched = 0;
  for (unsigned line = 0; line < lines; ++line)
    if (may_cover(cap, v.lines[line])) touched |= std::uint64_t(1) << line;
  tally(float(9 * lines));
  return touched;
}

/// Thread k of the block looks at sphere first + k.
template <From from>
__device__ void look_at_sphere(const VisibilitySpans& v, const BlockedScratch& s, vec3 x, unsigned first) {
  const unsigned k = threadIdx.x;
  if (first + k >= v.spheres.size) return;
  const Sphere sphere = v.spheres[first + k];
  tally(20);
  if constexpr (from == From::table) {
    const int entry = sphere_table_entry(v.bins, v.edge, sphere.centre, sphere.radius, x);
    std::uint64_t touched = entry == blocks_everything ? ~std::uint64_t(0) : 0;
    s.entry[k] = entry;
    if (entry >= 0) {
      const TableEntry found = v.entries[std::size_t(entry)];
      s.entry[k] = int(found.first), touched = found.lines;
    } else if (entry == beyond_table) {
      s.cap[k] = make_cap(sphere.centre, sphere.radius, x), touched = lines_of_cap(v, s.cap[k]);
    }
    s.touched[k] = touched;
  } else {
    s.cap[k] = make_cap(sphere.centre, sphere.radius, x);
    s.touched[k] = lines_of_cap(v, s.cap[k]);
  }
}

/// Fills words[0 .. v.words()); 0 in lines below the horizon. All threads of the block call it, and a barrier must
/// follow before others' words are read. `on_occluder`: an object's own spheres swallow its surface.
template <From from>
__device__ void find_blocked(const VisibilitySpans& v, const BlockedScratch& s, vec3 x, std::uint64_t active,
                             bool on_occluder, const SharedSpan<std::uint32_t>& words) {
  const unsigned count = on_occluder ? 0u : unsigned(v.spheres.size);
  for (unsigned w = threadIdx.x; w < v.words(); w += receiver_threads) words[w] = 0u;
  for (unsigned first = 0; first < count; first += receiver_threads) {
    const unsigned chunk = count - first < receiver_threads ? count - first : receiver_threads;
    look_at_sphere<from>(v, s, x, first);
    __syncthreads();
    for (unsigned w = threadIdx.x; w < v.words(); w += receiver_threads)
      if (active >> (w / words_per_line) & 1u) words[w] |= merge_word<from>(v, s, chunk, w);
    __syncthreads();
  }
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
    return {table_.bytes() + entries_.bytes() + directions_.bytes() + lines_.bytes(), 0, spheres_.bytes()};
  }

 private:
  void upload_tables(const Stream& stream, const VisibilitySource& source, const BlockedJob& job) {
    std::vector<Cone> lines;
    for (std::size_t k = 0; k < source.cones().axis.size(); ++k) lines.push_back(source.cones().cone(k));
    lines_.upload(stream, lines);
    directions_.upload(stream, source.directions());
    if (job.table) {
      table_.upload(stream, job.table->data()), entries_.upload(stream, job.table->entries());
      const SphereTable::Bins& bins = job.table->bins();
      spans_.edge = job.table->shape().edge, spans_.bins.count = bins.count, spans_.bins.per_ratio = bins.per_ratio;
      std::copy(bins.upper.begin(), bins.upper.end(), spans_.bins.upper.r2);
    }
    spans_.lines = lines_.span(), spans_.directions = directions_.span();
    spans_.table = table_.span(), spans_.entries = entries_.span();
    complete_ = true;
  }

  bool complete_ = false;  ///< the tables are there
  VisibilitySpans spans_;
  Buffer<Sphere> spheres_;
  Buffer<vec3> directions_;
  Buffer<Cone> lines_;
  Buffer<std::uint32_t> table_;
  Buffer<TableEntry> entries_;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
