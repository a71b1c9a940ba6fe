// visibility-filter and chen-2016 on the device. The host traces a ray a pixel and uploads what each found; a warp
// makes a word of bits of 64 pixels, then a thread a pixel filters, a row of its window at a time.
#include "cuda/kernels.h"
#include "cuda/lamp.h"
#include "cuda/surfaces.h"
#include "techniques/visibility_filter/chen_2016.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using visibility_filter::Filtering;
using visibility_filter::Links;
using Rows = DeviceSurfaces::Rows;

/// What the rays found, as visibility_filter::PixelMap: a pixel without a caster is open.
struct PixelSpans {
  Span<const float> depth, caster;
};

/// A word of 64 pixels, of which every lane of a warp has two: that of its number, and the one 32 further.
__device__ inline std::uint64_t word_of(bool low, bool high) {
  const std::uint64_t second = __ballot_sync(all_lanes, high);
  return second << 32 | __ballot_sync(all_lanes, low);
}

/// Makes the words of bits, a warp a word of a row; the margin's and the last of a row stay empty.
template <bool links>
__global__ void __launch_bounds__(threads) make_words(PixelSpans pixels, float epsilon, Rows rows) {
  const unsigned warp = global_thread() / warp_lanes, lane = threadIdx.x % warp_lanes;
  const int inner = rows.stride - 2, w = 1 + int(warp) % inner, y = int(warp) / inner;
  if (y >= rows.height) return;
  bool open[2], seen[2];
  Links link[2] = {};
  PENUMBRA_UNROLL
  for (int half = 0; half < 2; ++half) {
    const int x = 64 * w - Rows::margin + 32 * half + int(lane);
    const bool inside = x < rows.width;
    const float depth = inside ? pixels.depth[rows.pixel(x, y)] : 0.0f;
    seen[half] = inside && depth == depth;
    open[half] = inside && pixels.caster[rows.pixel(x, y)] == std::numeric_limits<float>::infinity();
    if (links && inside) link[half] = visibility_filter::links_of(pixels.depth, rows.width, rows.height, x, y, epsilon);
  }
  const std::uint64_t open_word = word_of(open[0], open[1]), seen_word = word_of(seen[0], seen[1]);
  const std::size_t k = rows.word(w, y);
  if (lane == 0) rows.open[k] = open_word, rows.seen[k] = seen_word;
  if constexpr (links) {
    const std::uint64_t right = word_of(link[0].right, link[1].right), down = word_of(link[0].down, link[1].down);
    const std::uint64_t down_right = word_of(link[0].down_right, link[1].down_right);
    const std::uint64_t down_left = word_of(link[0].down_left, link[1].down_left);
    if (lane == 0) rows.right[k] = right, rows.down[k] = down;
    if (lane == 0) rows.down_right[k] = down_right, rows.down_left[k] = down_left;
    if (lane == 0) rows.joined[k] = right & down & down_right & down_left;
    tally(8);
  }
}

/// A thread a word, of all words: the margin's are made empty once.
__global__ void __launch_bounds__(threads) clear_words(Span<std::uint64_t> words) {
  const std::size_t i = global_thread();
  if (i < words.size) words[i] = 0;
}

/// Which windows may hold both light and shadow, a thread a word: within a row, then within the columns.
__global__ void __launch_bounds__(threads) mix_rows(Rows rows, int r) {
  const int k = int(global_thread()), inner = rows.stride - 2, y = k / inner;
  if (y < rows.height) rows.look_across(1 + k % inner, y, r);
}
__global__ void __launch_bounds__(threads) mix_columns(Rows rows, int r) {
  const int k = int(global_thread()), inner = rows.stride - 2, y = k / inner;
  if (y < rows.height) rows.look_along(1 + k % inner, y, r);
}

/// Where a pixel lies in its image.
struct ImagePoint {
  int x, y;
};
__device__ inline ImagePoint point_of(const Rows& rows, std::size_t i) {
  return {int(i % std::size_t(rows.width)), int(i / std::size_t(rows.width))};
}

__global__ void __launch_bounds__(threads)
    find_radii(PixelSpans pixels, Rows rows, Filtering how, Span<const float> to_eye, Span<std::uint8_t> radius) {
  const std::size_t i = global_thread();
  if (i >= radius.size) return;
  const auto [x, y] = point_of(rows, i);
  radius[i] = std::uint8_t(visibility_filter::radius_by_bits(rows, pixels.depth, pixels.caster, x, y,
                                                             to_eye.size > 0 ? to_eye[i] : 1.0f, how));
  tally(20);
}

__global__ void __launch_bounds__(threads)
    filter_surfaces(Rows rows, Span<const std::uint8_t> radius, Span<float> visibility) {
  const std::size_t i = global_thread();
  if (i >= visibility.size) return;
  const auto [x, y] = point_of(rows, i);
  visibility[i] = visibility_filter::visibility_by_bits(rows, x, y, radius[i]);
  tally(1);
}

__global__ void __launch_bounds__(threads) filter_boxes(Rows rows, int r, Span<float> visibility) {
  const std::size_t i = global_thread();
  if (i >= visibility.size) return;
  const auto [x, y] = point_of(rows, i);
  visibility[i] = visibility_filter::box_by_bits(rows, x, y, r);
  tally(1);
}

// --- what is done with them ------------------------------------------------------------------------------------------

void DeviceSurfaces::resize(const Stream& stream, int width, int height) {
  rows_.width = width, rows_.height = height, rows_.stride = Rows::stride_for(width);
  Span<std::uint64_t>* const planes[] = {&rows_.open,       &rows_.seen,        &rows_.right,  &rows_.down,
                                         &rows_.down_right, &rows_.down_left,   &rows_.joined, &rows_.near_dark,
                                         &rows_.near_lit,   &rows_.near_joined, &rows_.mixed,  &rows_.whole};
  const std::size_t count = rows_.words();
  words_.resize(std::size(planes) * count);
  visibility_.resize(std::size_t(width) * std::size_t(height)), radius_.resize(visibility_.size());
  std::uint64_t* next = words_.span().data;
  for (Span<std::uint64_t>* plane : planes) *plane = {next, count}, next += count;
  launch(stream, PENUMBRA_KERNEL(clear_words), blocks_for(words_.size(), threads), threads, words_.span());
}

void DeviceSurfaces::upload(const Stream& stream, const visibility_filter::PixelMap& map) {
  depth_.upload(stream, map.depth), caster_.upload(stream, map.caster);
}

unsigned DeviceSurfaces::blocks_of_words(unsigned threads_a_word) const {
  return blocks_for(std::size_t(rows_.stride - 2) * std::size_t(rows_.height) * threads_a_word, threads);
}

void DeviceSurfaces::queue_mixed(const Stream& stream, int r) {
  launch(stream, PENUMBRA_KERNEL(mix_rows), blocks_of_words(), threads, rows_, r);
  launch(stream, PENUMBRA_KERNEL(mix_columns), blocks_of_words(), threads, rows_, r);
}

void DeviceSurfaces::queue_filter(const Stream& stream, const Filtering& how, Span<const float> to_eye) {
  const PixelSpans pixels{depth_.span(), caster_.span()};
  launch(stream, PENUMBRA_KERNEL(make_words<true>), blocks_of_words(warp_lanes), threads, pixels, how.epsilon, rows_);
  queue_mixed(stream, how.search_radius());
  const auto blocks = blocks_for(visibility_.size(), threads);
  launch(stream, PENUMBRA_KERNEL(find_radii), blocks, threads, pixels, rows_, how, to_eye, radius_.span());
  launch(stream, PENUMBRA_KERNEL(filter_surfaces), blocks, threads, rows_, radius_.span(), visibility_.span());
}

void DeviceSurfaces::queue_box(const Stream& stream, int r) {
  const PixelSpans pixels{depth_.span(), caster_.span()};
  launch(stream, PENUMBRA_KERNEL(make_words<false>), blocks_of_words(warp_lanes), threads, pixels, 0.0f, rows_);
  queue_mixed(stream, r);
  launch(stream, PENUMBRA_KERNEL(filter_boxes), blocks_for(visibility_.size(), threads), threads, rows_, r,
         visibility_.span());
}

// --- the techniques --------------------------------------------------------------------------------------------------

template <class Scalar>
class FilterOnDevice : public UnderLamp<Scalar> {
 public:
  using UnderLamp<Scalar>::UnderLamp;

  void shade(View<vec3> radiance) override {
    if (radiance.size() == 0) return;
    this->look();
    this->stage("pixels", [&] { surfaces_.upload(this->stream_, this->pixels_); });
    UnderLamp<Scalar>::shade(radiance);
  }

 protected:
  void trace() override {
    visibility_filter::trace_packets(this->rays_, *this->receivers_, this->lamp_.centre, this->pixels_);
  }
  void find_unshadowed() override {}  // by a kernel
  void filter() override {}

  void upload(const Changes& changed) override {
    if (changed.receivers) {
      surfaces_.resize(this->stream_, this->pixels_.width, this->pixels_.height);
      to_eye_.upload(this->stream_, this->receivers_->view_depth);
    }
    if (changed.light || changed.receivers) this->queue_light();
  }
  void queue() override {
    queue_filter();
    this->queue_compose(surfaces_.visibility());
  }
  virtual void queue_filter() = 0;

  Footprint device_bytes() const override { return {0, this->light_bytes() + to_eye_.bytes(), surfaces_.bytes()}; }

  DeviceSurfaces surfaces_;
  Buffer<float> to_eye_;
};

class AdaptiveOnDevice final : public FilterOnDevice<visibility_filter::Adaptive> {
 public:
  using FilterOnDevice::FilterOnDevice;
  std::map<std::string, std::size_t> counters() const override { return {}; }  // nobody counts there

 protected:
  void queue_filter() override { surfaces_.queue_filter(stream_, filtering_, to_eye_.span()); }
};

class FixedOnDevice final : public FilterOnDevice<visibility_filter::Fixed> {
 public:
  using FilterOnDevice::FilterOnDevice;

 protected:
  void queue_filter() override { surfaces_.queue_box(stream_, radius_); }
};

void add_visibility_filter(Makers& makers) {
  makers["visibility-filter"] = maker<AdaptiveOnDevice>();
  makers["chen-2016"] = maker<FixedOnDevice>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
