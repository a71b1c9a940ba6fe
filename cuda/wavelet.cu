// The wavelet techniques on the device: a block shades a receiver.
//
//   kernels=separate: the three kernels of Zhao & Che 2011, section 4: merge the spheres' bits, transform V, multiply;
//                     what passes between them lies in device memory. `wavelet` multiplies with the paper's loops over
//                     the kept terms, a thread a term.
//   kernels=fused:    one kernel; V never leaves shared memory, and the loops are merged into a functional of V.
// Where there are more than a few normals both multiply with the light's nine functions (wavelet/haar_lighting.h).
#include "techniques/wavelet/wavelet.h"

#include "cuda/haar.h"
#include "cuda/kernels.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using wavelet::Term;

constexpr unsigned most_blocks = 6 * 256, most_means = 6 * 341;  // n = 64

/// What depends on a receiver's normal: which plan, and the lines above the plan's horizon. Kernels for any normal do
/// without: they have one functional, and hide what lies below the receiver's own horizon.
struct PlanSpans {
  Span<const std::uint16_t> plan_of;
  Span<const std::uint64_t> active;
};

/// Fills words with what spheres block, and for any normal with what lies below the horizon.
template <From from, bool any_normal>
__device__ void find_hidden(const VisibilitySpans& v, const BlockedScratch& scratch, const ReceiverSpans& receivers,
                            const PlanSpans& plans, std::size_t i, const SharedSpan<std::uint32_t>& words) {
  const vec3 normal = receivers.normal[i];
  std::uint64_t active;
  if constexpr (any_normal) active = active_lines(v, normal);
  else active = plans.active[plans.plan_of[i]];
  find_blocked<from>(v, scratch, receivers.position[i], active, receivers.on_occluder[i] != 0, words);
  if constexpr (any_normal) {
    const Cap below{-normal, 0.0f};
    for (unsigned w = threadIdx.x; w < v.words(); w += receiver_threads)
      words[w] |= active >> (w / words_per_line) & 1u ? cap_word(v, below, w) : ~0u;
  }
  __syncthreads();
}

/// Which functional is the receiver's.
template <bool any_normal>
__device__ unsigned functional_of(const PlanSpans& plans, std::size_t i) {
  if constexpr (any_normal) return 0u;
  else return plans.plan_of[i];
}

/// Writes albedo * (sum over the block).
__device__ inline void write_sum(vec3 part, const SharedSpan<float>& scratch, vec3 albedo, vec3& out) {
  vec3 all;
  for (int c = 0; c < 3; ++c) all[c] = block_sum(part[c], scratch, receiver_warps);
  if (threadIdx.x == 0) out = albedo * all;
}

// --- one kernel ------------------------------------------------------------------------------------------------------

template <From from, bool any_normal>
__global__ void __launch_bounds__(receiver_threads)
    shade_wavelets(VisibilitySpans spheres, ReceiverSpans receivers, PlanSpans plans, FunctionalSpans functionals,
                   BinaryTableSpan table, Span<vec3> radiance) {
  PENUMBRA_SHARED(std::uint32_t, blocked, most_words);
  PENUMBRA_SHARED(int, entry, from == From::table ? receiver_threads : 1);
  PENUMBRA_SHARED(Cap, cap, receiver_threads);
  PENUMBRA_SHARED(std::uint64_t, touched, receiver_threads);
  // The table exists up to n = 32.
  PENUMBRA_SHARED(std::uint16_t, blocks, from == From::table ? most_blocks / 4 : most_blocks);
  PENUMBRA_SHARED(float, level1, from == From::table ? most_blocks / 4 : most_blocks);
  PENUMBRA_SHARED(float, means, from == From::table ? 6 * 85 : most_means);
  PENUMBRA_SHARED(float, sums, receiver_warps);
  const std::size_t i = blockIdx.x;
  if (!receivers.valid(i)) {
    if (threadIdx.x == 0) radiance[i] = vec3(0.0f);
    return;
  }
  find_hidden<from, any_normal>(spheres, {entry, cap, touched}, receivers, plans, i, blocked);
  const TwoLevelVisibility<SharedSpan<float>, SharedSpan<std::uint16_t>> v{spheres.n, level1, means, blocks, table};
  find_blocks(blocked, v);
  transform_means(v);
  write_sum(apply_functional<any_normal>(functionals, functional_of<any_normal>(plans, i), receivers.normal[i], v),
            sums, receivers.albedo[i], radiance[i]);
}

// --- the paper's three -----------------------------------------------------------------------------------------------

/// Visibility of some receivers in device memory, one after the other.
struct StoredVisibility {
  Span<std::uint32_t> words;
  Span<float> level1, means;
  Span<std::uint16_t> blocks;

  __device__ TwoLevelVisibility<Span<float>, Span<std::uint16_t>> of(std::size_t which, int n,
                                                                     const BinaryTableSpan& table) const {
    const int per_face = n * n / 16, pyramid = haar::pyramid_size(haar::levels_of(n / 4));
    return {n, part(level1, which, 6 * per_face), part(means, which, 6 * pyramid), part(blocks, which, 6 * per_face),
            table};
  }
};

/// Receiver first + k, k the block.
template <From from, bool any_normal>
__global__ void __launch_bounds__(receiver_threads)
    merge_spheres_of(VisibilitySpans spheres, ReceiverSpans receivers, PlanSpans plans, std::size_t first,
                     StoredVisibility store) {
  PENUMBRA_SHARED(std::uint32_t, blocked, most_words);
  PENUMBRA_SHARED(int, entry, from == From::table ? receiver_threads : 1);
  PENUMBRA_SHARED(Cap, cap, receiver_threads);
  PENUMBRA_SHARED(std::uint64_t, touched, receiver_threads);
  const std::size_t i = first + blockIdx.x;
  if (!receivers.valid(i)) return;
  find_hidden<from, any_normal>(spheres, {entry, cap, touched}, receivers, plans, i, blocked);
  for (unsigned w = threadIdx.x; w < spheres.words(); w += receiver_threads)
    store.words[blockIdx.x * spheres.words() + w] = blocked[w];
}

__global__ void __launch_bounds__(receiver_threads)
    transform_visibility(int n, ReceiverSpans receivers, std::size_t first, StoredVisibility store,
                         BinaryTableSpan table) {
  if (!receivers.valid(first + blockIdx.x)) return;
  const auto v = store.of(blockIdx.x, n, table);
  find_blocks(part(store.words, blockIdx.x, 6 * n * n / 32), v);
  transform_means(v);
}

/// Kept terms of the plans' cosine lobes ([plan][count]) and of the light ([channel][count]).
struct TermSpans {
  Span<const Term> p, light;
  unsigned count;
  wavelet::Levels levels;
};

/// The paper's loops: a third of the threads a channel, a thread terms in turn.
// Occupancy of multiply_terms: 64 registers in blocks of 6 warps leave room for 5 blocks, 47 %; held to 56 it spills.
__global__ void __launch_bounds__(receiver_threads)
    multiply_terms(ReceiverSpans receivers, PlanSpans plans, std::size_t first, StoredVisibility store,
                   BinaryTableSpan table, FunctionSpans lobes, FunctionSpans lights, TermSpans terms,
                   Span<vec3> radiance) {
  PENUMBRA_SHARED(float, sums, receiver_warps);
  const std::size_t i = first + blockIdx.x;
  if (!receivers.valid(i)) {
    if (threadIdx.x == 0) radiance[i] = vec3(0.0f);
    return;
  }
  const auto v = store.of(blockIdx.x, lobes.n, table);
  const unsigned plan = plans.plan_of[i];
  constexpr unsigned team = receiver_threads / 3;
  const unsigned channel = threadIdx.x / team, member = threadIdx.x % team;
  const FunctionSpans p = lobes.of(plan), light = lights.of(channel);
  wavelet::Evaluate<decltype(store.of(0, 0, table)), float> sink(v);
  if (member < 6) sink.coefficient(int(member), 0, p.at(int(member), 0) * light.at(int(member), 0));  // case 1
  for (unsigned k = member; k < terms.count; k += team) {
    wavelet::add_p_term(p, light, terms.p[plan * terms.count + k], terms.levels, sink);
    tally(7);
  }
  for (unsigned k = member; k < terms.count; k += team) {
    wavelet::add_light_term(p, light, terms.light[channel * terms.count + k], terms.levels, sink);
    tally(1);
  }
  vec3 part(0.0f);
  part[int(channel)] = sink.sum();
  write_sum(part, sums, receivers.albedo[i], radiance[i]);
}

template <bool any_normal>
__global__ void __launch_bounds__(receiver_threads)
    multiply_functional(int n, ReceiverSpans receivers, PlanSpans plans, std::size_t first, StoredVisibility store,
                        BinaryTableSpan table, FunctionalSpans functionals, Span<vec3> radiance) {
  PENUMBRA_SHARED(float, sums, receiver_warps);
  const std::size_t i = first + blockIdx.x;
  if (!receivers.valid(i)) {
    if (threadIdx.x == 0) radiance[i] = vec3(0.0f);
    return;
  }
  write_sum(apply_functional<any_normal>(functionals, functional_of<any_normal>(plans, i), receivers.normal[i],
                                         store.of(blockIdx.x, n, table)),
            sums, receivers.albedo[i], radiance[i]);
}

// --- the technique ---------------------------------------------------------------------------------------------------

/// With functionals of V; what a member does otherwise it overrides.
template <class Scalar>
class WaveletOnDevice : public OnDevice<Scalar> {
  using Base = OnDevice<Scalar>;

 public:
  explicit WaveletOnDevice(const Parameters& p)
      : Base(p), fused_(p.text("kernels") == "fused"), visibility_on_device_(this->visibility_) {}

 protected:
  using Base::n_, Base::plan_of_, Base::stream_, Base::radiance_, Base::receivers, Base::receiver_count;
  static constexpr std::size_t chunk = 16384;  // receivers whose V is stored at a time: 80 MB at n = 32

  void upload(const Changes& changed) override {
    visibility_on_device_.upload(stream_, this->visibility_, changed);
    if (table_.size() == 0) upload_table();
    if (changed.receivers || changed.light) {
      plan_index_.upload(stream_, plan_of_.index), active_on_device_.upload(stream_, this->active_);
      upload_plans();
    }
    if (!fused_ && changed.receivers) resize_store();
  }

  void queue() override {
    const bool table = visibility_on_device_.from() == From::table;
    if (this->few()) return table ? queue_from<From::table, false>() : queue_from<From::raster, false>();
    table ? queue_from<From::table, true>() : queue_from<From::raster, true>();
  }

  Footprint device_bytes() const override {
    Footprint bytes = visibility_on_device_.bytes();
    bytes.tables += table_.bytes();
    bytes.per_scene += plan_index_.bytes() + active_on_device_.bytes() + functional_level1_.bytes() + slot_.bytes() +
                       functional_level2_.bytes();
    bytes.per_frame += words_.bytes() + level1_.bytes() + means_.bytes() + blocks_.bytes();
    return bytes;
  }

  virtual void upload_plans() {
    std::vector<float> level1, level2;
    std::vector<std::int32_t> slots;
    for (const wavelet::Functional& f : this->make_functionals()) {
      const auto first = std::int32_t(level2.size() / std::size_t(f.channels * 16));
      for (const auto& channel : f.level1) level1.insert(level1.end(), channel.begin(), channel.end());
      for (const std::int32_t slot : f.slot) slots.push_back(slot < 0 ? slot : first + slot);
      level2.insert(level2.end(), f.level2.begin(), f.level2.end());
    }
    functional_level1_.upload(stream_, level1), slot_.upload(stream_, slots);
    functional_level2_.upload(stream_, level2);
  }

  /// The last of the paper's kernels, for `blocks` receivers from `first` on.
  virtual void queue_product(unsigned blocks, std::size_t first, const StoredVisibility& store) {
    const auto run = [&](const auto& kernel) {
      launch(stream_, kernel, blocks, receiver_threads, n_, receivers(), plans(), first, store, table(), functionals(),
             radiance_.span());
    };
    this->few() ? run(PENUMBRA_KERNEL(multiply_functional<false>)) : run(PENUMBRA_KERNEL(multiply_functional<true>));
  }

  PlanSpans plans() const { return {plan_index_.span(), active_on_device_.span()}; }
  BinaryTableSpan table() const { return {table_.span()}; }

  const bool fused_;

 private:
  FunctionalSpans functionals() const { return {functional_level1_.span(), slot_.span(), functional_level2_.span()}; }

  void upload_table() {
    std::vector<std::int8_t> entries;
    for (unsigned block = 0; block < 65536; ++block)
      entries.insert(entries.end(), haar::binary_table()[block], haar::binary_table()[block] + 16);
    table_.upload(stream_, entries);
  }

  void resize_store() {
    const std::size_t count = std::min(chunk, receiver_count()), texels = std::size_t(this->all_);
    words_.resize(count * texels / 32);
    level1_.resize(count * texels / 16), blocks_.resize(count * texels / 16);
    means_.resize(count * 6 * std::size_t(haar::pyramid_size(haar::levels_of(n_ / 4))));
  }

  template <From from, bool any_normal>
  void queue_from() {
    const VisibilitySpans& spheres = visibility_on_device_.spans();
    if (fused_)
      return launch(stream_, PENUMBRA_KERNEL((shade_wavelets<from, any_normal>)), unsigned(receiver_count()),
                    receiver_threads, spheres, receivers(), plans(), functionals(), table(), radiance_.span());
    const StoredVisibility store{words_.span(), level1_.span(), means_.span(), blocks_.span()};
    for (std::size_t first = 0; first < receiver_count(); first += chunk) {
      const auto blocks = unsigned(std::min(chunk, receiver_count() - first));
      launch(stream_, PENUMBRA_KERNEL((merge_spheres_of<from, any_normal>)), blocks, receiver_threads, spheres,
             receivers(), plans(), first, store);
      launch(stream_, PENUMBRA_KERNEL(transform_visibility), blocks, receiver_threads, n_, receivers(), first, store,
             table());
      queue_product(blocks, first, store);
    }
  }

  DeviceVisibility visibility_on_device_;
  Buffer<std::int8_t> table_;
  Buffer<std::uint16_t> plan_index_;
  Buffer<std::uint64_t> active_on_device_;
  Buffer<float> functional_level1_, functional_level2_;
  Buffer<std::int32_t> slot_;
  Buffer<std::uint32_t> words_;
  Buffer<float> level1_, means_;
  Buffer<std::uint16_t> blocks_;
};

/// kernels=separate multiplies with the paper's loops.
class SparseOnDevice final : public WaveletOnDevice<wavelet::Wavelet> {
 public:
  using WaveletOnDevice::WaveletOnDevice;

 protected:
  void upload_plans() override {
    if (fused_ || !few()) return WaveletOnDevice::upload_plans();
    std::vector<float> p, p_means, light, light_means;
    std::vector<Term> p_terms, light_terms;
    const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
    for (const wavelet::SparsePlan& plan : plans_)
      append(p, plan.p.coefficients), append(p_means, plan.p.means), append(p_terms, plan.kept);
    for (int c = 0; c < 3; ++c) {
      append(light, channel_[c].coefficients), append(light_means, channel_[c].means);
      append(light_terms, kept_[c]);
    }
    p_.upload(stream_, p), p_means_.upload(stream_, p_means), p_terms_.upload(stream_, p_terms);
    light_coefficients_.upload(stream_, light), light_means_.upload(stream_, light_means);
    light_terms_.upload(stream_, light_terms);
  }

  void queue_product(unsigned blocks, std::size_t first, const StoredVisibility& store) override {
    if (!few()) return WaveletOnDevice::queue_product(blocks, first, store);
    launch(stream_, PENUMBRA_KERNEL(multiply_terms), blocks, receiver_threads, receivers(), plans(), first, store,
           table(), FunctionSpans{n_, p_.span(), p_means_.span()},
           FunctionSpans{n_, light_coefficients_.span(), light_means_.span()},
           TermSpans{p_terms_.span(), light_terms_.span(), unsigned(keep_.terms), levels_}, radiance_.span());
  }

  Footprint device_bytes() const override {
    Footprint bytes = WaveletOnDevice::device_bytes();
    bytes.per_scene += p_.bytes() + p_means_.bytes() + light_coefficients_.bytes() + light_means_.bytes() +
                       p_terms_.bytes() + light_terms_.bytes();
    return bytes;
  }

 private:
  Buffer<float> p_, p_means_, light_coefficients_, light_means_;
  Buffer<Term> p_terms_, light_terms_;
};

void add_wavelet(Makers& makers) {
  makers["wavelet"] = maker<SparseOnDevice>();
  makers["wavelet-product"] = maker<WaveletOnDevice<wavelet::WaveletProduct>>();
  makers["wavelet-dense"] = maker<WaveletOnDevice<wavelet::WaveletDense>>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
