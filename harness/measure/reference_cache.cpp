// References on disk: EXR files named by the hash of what they depend on, with a checksum of their pixels inside.

#include <algorithm>

#include "harness/measure/reference.h"
#include "scenes/content.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/storage/cache.h"

namespace penumbra {
namespace {

constexpr int format_version = 7;  // raise when a rung's algorithm changes: old files are then never looked at

void add_light(ContentHash& hash, const Light& light) {
  if (std::holds_alternative<Lights>(light))
    for (const Light& one : each_of(light)) add_light(hash, one);
  if (const Environment* e = environment_of(light)) {
    hash.add_value(int(e->mapping));
    hash.add_value(e->width);
    hash.add_value(e->rotation);
    hash.add(e->radiance);
  }
  if (const AreaLight* a = area_light_of(light)) {
    hash.add_value(int(a->shape));
    for (const vec3 v : {a->centre, a->edge_u, a->edge_v, a->normal, a->radiance}) add_vec(hash, v);
  }
}

const std::vector<std::string> channels = {
    "R", "G", "B", "variance.R", "variance.G", "variance.B", "unshadowed.R", "unshadowed.G", "unshadowed.B"};

/// EXR files keep channels in alphabetical order; this brings back ours.
void reorder(ChannelImage& file, const std::string& path) {
  std::vector<std::size_t> from;
  for (const std::string& name : channels) {
    const auto at = std::find(file.channels.begin(), file.channels.end(), name);
    if (at == file.channels.end()) throw Error("{}: the channel {} is missing", path, name);
    from.push_back(std::size_t(at - file.channels.begin()));
  }
  const std::size_t stride = file.channels.size();
  std::vector<float> values;
  values.reserve(file.values.size() / stride * from.size());
  for (std::size_t i = 0; i < file.values.size(); i += stride)
    for (const std::size_t c : from) values.push_back(file.values[i + c]);
  file.values = std::move(values);
  file.channels = channels;
}

/// Throws Error if the file is not whole or not ours.
Reference load(const std::string& path, const std::string& key, Rung rung) {
  ChannelImage file = load_channels(path);
  const auto attribute = [&](const char* name) { return file.attributes[std::string("penumbra:") + name]; };
  if (attribute("key") != key) throw Error("{}: belongs to something else", path);
  reorder(file, path);
  if (attribute("checksum") != checksum(file.values)) throw Error("{}: the checksum does not match", path);
  Reference r;
  r.rung = rung;
  r.from_cache = true;
  r.rays_per_receiver = std::stoi(attribute("rays"));
  r.seconds = std::stod(attribute("seconds"));
  for (Image* image : {&r.mean, &r.variance, &r.unshadowed}) *image = {file.width, file.height, {}};
  for (std::size_t i = 0; i < file.values.size(); i += channels.size()) {
    const float* v = &file.values[i];
    r.mean.pixels.emplace_back(v[0], v[1], v[2]);
    r.variance.pixels.emplace_back(v[3], v[4], v[5]);
    r.unshadowed.pixels.emplace_back(v[6], v[7], v[8]);
  }
  return r;
}

void store(const std::string& path, const std::string& key, const Reference& r) {
  ChannelImage file{r.mean.width, r.mean.height, channels, {}, {}};
  for (std::size_t i = 0; i < r.mean.pixels.size(); ++i)
    for (const Image* image : {&r.mean, &r.variance, &r.unshadowed})
      for (int c = 0; c < 3; ++c) file.values.push_back(image->pixels[i][c]);
  file.attributes = {{"penumbra:key", key},
                     {"penumbra:checksum", checksum(file.values)},
                     {"penumbra:rays", std::to_string(r.rays_per_receiver)},
                     {"penumbra:seconds", std::to_string(r.seconds)}};
  save_channels(path, file);
}

CacheEntry cache_entry(Rung rung, const std::string& key) {
  return {to_string(rung) + "-" + key + ".exr", "reference cache", "computing it anew", log_warning};
}

}  // namespace

std::string reference_key(const Frame& frame, Rung rung, const ReferenceSettings& settings) {
  ContentHash hash(format_version);
  hash.add_value(int(rung));
  if (rung == Rung::truth) hash.add_value(settings.truth_noise), hash.add_value(settings.most_rays);
  if (rung == Rung::cube || rung == Rung::spheres) hash.add_value(settings.resolution);
  if (rung == Rung::spheres) {
    for (const Sphere& s : frame.spheres.spheres) add_vec(hash, s.centre), hash.add_value(s.radius);
  } else {
    add_mesh(hash, frame.mesh);
  }
  const Receivers& r = frame.receivers;
  hash.add_value(r.width);
  hash.add(r.position);
  hash.add(r.origin);
  hash.add(r.normal);
  hash.add(r.albedo);
  hash.add(r.on_occluder);
  add_light(hash, frame.light);
  return hash.digest();
}

bool is_cached(const Frame& frame, Rung rung, const ReferenceSettings& settings) {
  return cache_entry(rung, reference_key(frame, rung, settings)).exists();
}

Reference cached_reference(const Frame& frame, Rung rung, const ReferenceSettings& settings,
                           const ReferenceProgress& progress) {
  const std::string key = reference_key(frame, rung, settings);
  const auto checked = [&](const std::string& path) {
    Reference reference = load(path, key, rung);
    check_finite(reference, frame.receivers);
    warn_of_noise(reference, frame.receivers, settings);  // of a file as of a fresh one
    return reference;
  };
  return cache_entry(rung, key).get(
      checked, [&] { return compute_reference(frame, rung, settings, progress); },
      [&](const std::string& path, const Reference& reference) { store(path, key, reference); });
}

}  // namespace penumbra
