#include "techniques/registry.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "scenes/error.h"
#include "scenes/nearest_name.h"
#include "techniques/several_lights.h"

namespace penumbra {
namespace {

void check_knobs(const Entry& entry) {
  int fine = 0;
  for (const Knob& knob : entry.knobs) {
    if (knob.values.empty()) throw Error("technique {}: knob '{}' has no values", entry.title(), knob.parameter);
    for (const ParameterValue& value : knob.values) {
      if (knob.fine && !std::holds_alternative<int>(value))
        throw Error("technique {}: the fine knob '{}' must hold integers", entry.title(), knob.parameter);
      Parameters given;
      given.set(knob.parameter, value);
      given.resolve(entry.parameters, entry.title());
    }
    fine += knob.fine;
  }
  if (fine > 1) throw Error("technique {} has {} fine knobs; allowed is one", entry.title(), fine);
}

}  // namespace

std::string to_string(Backend backend) {
  constexpr const char* names[] = {"scalar", "simd", "cuda", "external"};
  return names[int(backend)];
}

void Registry::add(Entry entry) {
  if (twin(entry, entry.backend)) throw Error("technique {} is registered twice", entry.title());
  std::set<std::string> names;
  for (const Parameter& p : entry.parameters)
    if (!names.insert(p.name).second) throw Error("technique {} declares '{}' twice", entry.title(), p.name);
  check_knobs(entry);
  entries_.push_back(std::move(entry));
}

const Entry& Registry::find(const std::string& name, const std::string& backend) const {
  std::set<std::string> names, backends;
  for (const Entry& entry : entries_) {
    if (entry.name == name && to_string(entry.backend) == backend) return entry;
    names.insert(entry.name);
    if (entry.name == name) backends.insert(to_string(entry.backend));
  }
  if (backends.empty())
    throw Error("unknown technique '{}'; known are: {}{}", name, fmt::join(names, ", "),
                did_you_mean(name, {names.begin(), names.end()}));
  throw Error("technique '{}' has no backend '{}'; it has: {}", name, backend, fmt::join(backends, ", "));
}

const Entry* Registry::twin(const Entry& entry, Backend backend) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& other) {
    return other.name == entry.name && other.backend == backend;
  });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<Backend> Registry::usual_backends(const std::string& name) const {
  std::vector<Backend> usual, all;
  for (const Entry& entry : entries_) {
    if (entry.name != name) continue;
    all.push_back(entry.backend);
    if (entry.backend == Backend::scalar || entry.backend == Backend::simd) usual.push_back(entry.backend);
  }
  if (all.empty()) find(name, "");        // which throws
  std::sort(usual.begin(), usual.end());  // scalar before simd, whatever order they came in
  return usual.empty() ? all : usual;
}

std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters) {
  if (!entry.unavailable.empty()) throw Unsupported(entry.title() + " cannot run: " + entry.unavailable);
  return entry.make(parameters.resolve(entry.parameters, entry.title()));
}

std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters, const Light& light) {
  if (each_of(light).size() == 1) return make_technique(entry, parameters);
  if (entry.backend == Backend::cuda) throw Unsupported("several lights: not on a device");
  const Parameters all = parameters.resolve(entry.parameters, entry.title());
  return std::make_unique<SeveralLights>([entry, all](std::size_t number) {
    Parameters own = all;
    const auto seed = own.all().find("seed");
    if (seed != own.all().end()) own.set("seed", (std::get<int>(seed->second) + int(number)) % (1 << 30));
    return make_technique(entry, own);
  });
}

}  // namespace penumbra
