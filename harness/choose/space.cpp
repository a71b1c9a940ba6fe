#include "harness/choose/space.h"

#include <algorithm>

#include "scenes/error.h"

namespace penumbra {
namespace {

/// Does the technique take this combination?
bool makes(const Line& line) {
  try {
    line.entry->make(line.at(line.values.empty() ? 0 : line.values.front()));
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

Parameters Line::at(int value) const {
  Parameters given = fixed;
  if (!knob.empty()) given.set(knob, value);
  return given.resolve(entry->parameters, entry->title());
}

bool Line::reads_spheres() const {
  return entry->reads_spheres(at(values.empty() ? 0 : values.front()));
}

std::vector<Line> lines_of(const Entry& entry) {
  std::vector<Line> lines = {{&entry, {}, "", {}}};
  for (const Knob& knob : entry.knobs) {
    if (knob.fine) {
      for (Line& line : lines) {
        line.knob = knob.parameter;
        for (const ParameterValue& value : knob.values) line.values.push_back(std::get<int>(value));
      }
      continue;
    }
    std::vector<Line> grown;
    for (const Line& line : lines)
      for (const ParameterValue& value : knob.values) {
        grown.push_back(line);
        grown.back().fixed.set(knob.parameter, value);
      }
    lines = std::move(grown);
  }
  std::erase_if(lines, [](const Line& line) { return !makes(line); });
  return lines;
}

std::vector<const Entry*> contenders(const Registry& registry) {
  std::vector<const Entry*> all;
  for (const Entry& entry : registry.entries()) {
    if (entry.knobs.empty()) continue;  // its author did not ask for a search
    const bool faster_twin = std::any_of(registry.entries().begin(), registry.entries().end(), [&](const Entry& other) {
      return other.name == entry.name && other.backend != Backend::scalar && other.unavailable.empty();
    });
    if (entry.unavailable.empty() && (entry.backend != Backend::scalar || !faster_twin)) all.push_back(&entry);
  }
  return all;
}

}  // namespace penumbra
