// pcss, hqepcss and fast-pcss on the device, a thread a receiver. The shadow map's rays are traced on the host and its
// depths uploaded; levels of the multi-scale map, regions, links, blockers, filter and blur are kernels. Where
// neighbours share a result, those that find one are gathered first, so that whole warps have work.
#include "cuda/kernels.h"
#include "cuda/soft_shadow_kernels.h"
#include "techniques/pcss/pcss.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

class SoftShadowOnDevice : public UnderLamp<pcss::SoftShadow> {
 public:
  using UnderLamp::UnderLamp;

 protected:
  void find_unshadowed(const LampOutline&, int, int, float*) const override {}  // by a kernel
  void map_changed() override {
    if (options_.multi_scale && samples_.stride() != map_.stride())
      samples_ = pcss::LeafSamples(shadow_map::make_sample_image(), map_);
  }

  void upload(const Changes& changed) override {
    if (changed.receivers) resize(receiver_count());
    if (kernel_on_device_.size() == 0) kernel_on_device_.upload(stream_, kernel_);
    if (options_.multi_scale && sample_offsets_.size() == 0) sample_offsets_.upload(stream_, samples_.offsets());
    if (!changed.mesh && !changed.light && !changed.receivers) return;
    depth_.upload(stream_, map_.depth);
    largest_ = options_.multi_scale ? largest_needed() : 0;
    const std::size_t squares =
        options_.multi_scale ? std::size_t(largest_ + 1) * std::size_t(map_.resolution()) * map_.resolution() : 0;
    bounds_.resize(2 * squares), means_.resize(squares);
    build();
  }

  void queue() override {
    const auto each = blocks_of_receivers();
    ReceiverState r = state();
    launch(stream_, PENUMBRA_KERNEL(search_regions), each, threads, map_.view, const_levels(), options_, bias_,
           receivers(), r);
    r.link = share(options_.search_reuse, r);
    queue_blockers(r);
    const Span<int> before = r.link;
    r.link = before.data == link_.span().data ? linked_.span() : link_.span();
    launch(stream_, PENUMBRA_KERNEL(make_filter_regions_of), each, threads, map_.view, largest_, options_, before, r);
    r.link = share(options_.filter_reuse, r);
    queue_filter(r);
    queue_image(r);
  }

  Footprint device_bytes() const override {
    const std::size_t state_bytes = at_.bytes() + width_.bytes() + square_.bytes() + link_.bytes() + linked_.bytes() +
                                    blocker_.bytes() + visibility_.bytes() + list_.bytes() + value_.bytes() +
                                    weight_.bytes() + value_between_.bytes() + weight_between_.bytes();
    return {kernel_on_device_.bytes() + sample_offsets_.bytes(), light_bytes(),
            depth_.bytes() + bounds_.bytes() + means_.bytes() + state_bytes};
  }

 private:
  void resize(std::size_t n) {
    at_.resize(n), width_.resize(n), square_.resize(n), link_.resize(n), linked_.resize(n), blocker_.resize(n);
    visibility_.resize(n), list_.resize(n), value_.resize(n), weight_.resize(n);
    value_between_.resize(n), weight_between_.resize(n), gathered_.resize(1);
  }

  ReceiverState state() {
    return {at_.span(),      width_.span(),      square_.span(),  link_.span(),
            blocker_.span(), visibility_.span(), receiver_count()};
  }
  MapSpans depths() const { return {depth_.span(), map_.resolution(), map_.stride()}; }
  SampledMap map() const { return {depths(), sample_offsets_.span()}; }
  template <class Floats>
  Levels<Floats> levels_of(Floats bounds, Floats means) const {
    return {options_.layout, map_.resolution(), largest_, bounds, means};
  }
  Levels<Span<const float>> const_levels() const { return levels_of<Span<const float>>(bounds_.span(), means_.span()); }

  /// What depends on light, map and receivers alone, once they change: unshadowed light, and the multi-scale map.
  void build() {
    queue_light();
    if (!options_.multi_scale) return;
    const auto levels = levels_of<Span<float>>(bounds_.span(), means_.span());
    const auto squares = [&](int level) { return std::size_t(levels.stride(level)) * levels.stride(level); };
    launch(stream_, PENUMBRA_KERNEL(copy_map), blocks_for(squares(0), threads), threads, depths(), levels);
    for (int level = 1; level <= largest_; ++level)
      launch(stream_, PENUMBRA_KERNEL(build_level), blocks_for(squares(level), threads), threads, levels, level);
  }

  /// Links after sharing, and the list of receivers that find a result of their own.
  Span<int> share(const pcss::Reuse& how, const ReceiverState& r) {
    const auto each = blocks_of_receivers();
    Span<int> links = r.link;
    if (how.area > 1) {
      links = r.link.data == link_.span().data ? linked_.span() : link_.span();
      launch(stream_, PENUMBRA_KERNEL(link_neighbours), each, threads, how, receivers().width, r, links);
    }
    launch(stream_, PENUMBRA_KERNEL(clear_count), 1, warp_lanes, gathered_.span());
    launch(stream_, PENUMBRA_KERNEL(gather), each, threads, links, list_.span(), gathered_.span());
    return links;
  }

  void queue_blockers(const ReceiverState& r) {
    const auto run = [&](const auto& kernel) {
      launch(stream_, kernel, blocks_for(r.count, threads), threads, map(), const_levels(), options_.depth,
             list_.span(), gathered_.span(), r);
    };
    if (options_.search == Sum::texels) run(PENUMBRA_KERNEL(sum_blockers<Sum::texels>));
    else if (options_.search == Sum::nearest) run(PENUMBRA_KERNEL(sum_blockers<Sum::nearest>));
    else run(PENUMBRA_KERNEL(sum_blockers<Sum::sampled>));
  }
  void queue_filter(const ReceiverState& r) {
    const auto run = [&](const auto& kernel) {
      launch(stream_, kernel, blocks_for(r.count, threads), threads, map(), const_levels(), options_.depth,
             list_.span(), gathered_.span(), r);
    };
    if (options_.filter == Sum::texels) run(PENUMBRA_KERNEL(sum_filter<Sum::texels>));
    else if (options_.filter == Sum::nearest) run(PENUMBRA_KERNEL(sum_filter<Sum::nearest>));
    else run(PENUMBRA_KERNEL(sum_filter<Sum::sampled>));
  }

  void queue_image(const ReceiverState& r) {
    const auto each = blocks_of_receivers();
    const MaskedSpans image{value_.span(), weight_.span()}, between{value_between_.span(), weight_between_.span()};
    launch(stream_, PENUMBRA_KERNEL(spread_visibility), each, threads, receivers(), r, image);
    if (options_.blur > 0) {
      const int width = receivers().width;
      launch(stream_, PENUMBRA_KERNEL(blur_image_rows), each, threads, image, kernel_on_device_.span(), width, between);
      launch(stream_, PENUMBRA_KERNEL(blur_image_columns), each, threads, between, kernel_on_device_.span(), width,
             value_.span());
    }
    queue_compose(value_.span());
  }

  int largest_ = 0;
  Buffer<float> depth_, bounds_, means_, kernel_on_device_;
  Buffer<std::int32_t> sample_offsets_;
  Buffer<shadow_map::Projected> at_;
  Buffer<Square> square_;
  Buffer<float> width_, blocker_, visibility_;
  Buffer<float> value_, weight_, value_between_, weight_between_;
  Buffer<int> link_, linked_, list_;
  Buffer<unsigned> gathered_;
};

void add_soft_shadow(Makers& makers) {
  makers["pcss"] = maker<pcss::Member<SoftShadowOnDevice, pcss::pcss_options>>();
  makers["hqepcss"] = maker<pcss::Member<SoftShadowOnDevice, pcss::hqepcss_options>>();
  makers["fast-pcss"] = maker<pcss::Member<SoftShadowOnDevice, pcss::fast_pcss_options>>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
