#include "techniques/registry.h"

#include <fmt/ranges.h>

#include <set>

#include "scenes/error.h"

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

void Registry::add(Entry entry) {
  for (const Entry& other : entries_)
    if (other.name == entry.name && other.backend == entry.backend)
      throw Error("technique {} is registered twice", entry.title());
  std::set<std::string> names;
  for (const Parameter& p : entry.parameters)
    if (!names.insert(p.name).second) throw Error("technique {} declares '{}' twice", entry.title(), p.name);
  check_knobs(entry);
  entries_.push_back(std::move(entry));
}

const Entry& Registry::find(const std::string& name, const std::string& backend) const {
  std::set<std::string> names, backends;
  for (const Entry& entry : entries_) {
    if (entry.name == name && entry.backend == backend) return entry;
    names.insert(entry.name);
    if (entry.name == name) backends.insert(entry.backend);
  }
  if (backends.empty()) throw Error("unknown technique '{}'; known are: {}", name, fmt::join(names, ", "));
  throw Error("technique '{}' has no backend '{}'; it has: {}", name, backend, fmt::join(backends, ", "));
}

std::unique_ptr<Technique> make_technique(const Entry& entry, const Parameters& parameters) {
  if (!entry.unavailable.empty()) throw Unsupported(entry.title() + " cannot run: " + entry.unavailable);
  return entry.make(parameters.resolve(entry.parameters, entry.title()));
}

}  // namespace penumbra
