// What every technique does alike on the device: a stream, a graph of its launches, receivers that stay, stages by
// events, one transfer back a frame.
#pragma once

#include <memory>

#include "cuda/kernel.h"
#include "techniques/technique.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

/// Times by events on a stream.
class EventClock final : public Clock {
 public:
  explicit EventClock(const Stream& stream) : stream_(stream) {}
  void start() override { last_->record(stream_); }
  double lap() override {
    now_->record(stream_);
    const double ms = Event::milliseconds(*last_, *now_);
    std::swap(last_, now_);
    return ms;
  }

 private:
  const Stream& stream_;
  std::unique_ptr<Event> last_ = std::make_unique<Event>(), now_ = std::make_unique<Event>();
};

/// Named stretches of a stream.
class StageEvents {
 public:
  template <class Work>
  void measure(const Stream& stream, const std::string& name, const Work& work) {
    Stretch& stretch = find(name);
    stretch.from.record(stream);
    work();
    stretch.to.record(stream);
    stretch.ran = true;
  }
  /// Stages that do not run until the next stages() took no time.
  void reset() {
    for (const auto& s : stretches_) s->ran = false;
  }
  std::vector<Stage> stages() const {
    std::vector<Stage> out;
    for (const auto& s : stretches_) out.push_back({s->name, s->ran ? Event::milliseconds(s->from, s->to) : 0.0});
    return out;
  }

 private:
  struct Stretch {
    std::string name;
    Event from, to;
    bool ran = false;
  };
  Stretch& find(const std::string& name) {
    for (const auto& s : stretches_)
      if (s->name == name) return *s;
    stretches_.push_back(std::make_unique<Stretch>());
    stretches_.back()->name = name;
    return *stretches_.back();
  }
  std::vector<std::unique_ptr<Stretch>> stretches_;
};

/// Receivers as kernels see them.
struct ReceiverSpans {
  Span<const vec3> position, normal, albedo;
  Span<const std::uint8_t> on_occluder, touches;
  int width = 0, height = 0;
  __device__ bool valid(std::size_t i) const { return normal[i] != vec3(0.0f); }
};

class DeviceReceivers {
 public:
  void upload(const Stream& stream, const Receivers& r) {
    position_.upload(stream, r.position);
    normal_.upload(stream, r.normal);
    albedo_.upload(stream, r.albedo);
    on_occluder_.upload(stream, r.on_occluder);
    touches_.upload(stream, r.in_contact());
    width_ = r.width, height_ = r.height;
  }
  ReceiverSpans spans() const {
    return {position_.span(), normal_.span(), albedo_.span(), on_occluder_.span(), touches_.span(), width_, height_};
  }
  std::size_t bytes() const {
    return position_.bytes() + normal_.bytes() + albedo_.bytes() + on_occluder_.bytes() + touches_.bytes();
  }

 private:
  Buffer<vec3> position_, normal_, albedo_;
  Buffer<std::uint8_t> on_occluder_, touches_;
  int width_ = 0, height_ = 0;
};

/// A technique's scalar class with its inner loops on the device. A member uploads what has changed in upload(), queues
/// its kernels in queue(), and leaves radiance in `radiance_`.
template <class Scalar>
class OnDevice : public Scalar {
 public:
  using Scalar::Scalar;

  void prepare(const Scene& scene, const Light& light) override {
    Scalar::prepare(scene, light);
    begin(scene.receivers, {true, true, true, true});
  }
  void update(const Frame& frame) override {
    stages_.reset();
    Scalar::update(frame);
    const Changes& c = frame.changed;
    if (c.mesh || c.spheres || c.receivers || c.light) begin(frame.receivers, c);
  }
  void shade(View<vec3> radiance) override {
    if (radiance.size() == 0) return;
    stages_.measure(stream_, "kernels", [&] { graph_.run(stream_, [&] { queue(); }); });
    stages_.measure(stream_, "download", [&] { radiance_.download(stream_, radiance.data); });
  }

  std::unique_ptr<Clock> make_clock() const override { return std::make_unique<EventClock>(stream_); }
  std::vector<Stage> stages() const override { return stages_.stages(); }
  Footprint footprint() const override {
    Footprint bytes = device_bytes();
    bytes.per_scene += receivers_on_device_.bytes() + radiance_.bytes();
    return bytes;
  }

 protected:
  /// Brings to the device what the frame changed. The scalar class has taken it in already.
  virtual void upload(const Changes& changed) = 0;
  /// Launches all kernels of a frame. They are captured into a graph that lives until the next change.
  virtual void queue() = 0;
  /// Bytes in device memory, without those of receivers and radiance.
  virtual Footprint device_bytes() const = 0;

  /// A stretch of the stream that stages() tells.
  template <class Work>
  void stage(const std::string& name, const Work& work) {
    stages_.measure(stream_, name, work);
  }

  ReceiverSpans receivers() const { return receivers_on_device_.spans(); }
  std::size_t receiver_count() const { return radiance_.size(); }

  Stream stream_;
  Buffer<vec3> radiance_;

 private:
  void begin(const Receivers& receivers, const Changes& changed) {
    graph_.forget();
    stages_.measure(stream_, "upload", [&] {
      if (changed.receivers) {
        receivers_on_device_.upload(stream_, receivers);
        radiance_.resize(std::size_t(receivers.size()));
      }
      upload(changed);
    });
  }
  Graph graph_;
  StageEvents stages_;
  DeviceReceivers receivers_on_device_;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
