#include "scenes/image_layers.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "scenes/error.h"

namespace penumbra {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// OpenEXR writes R; some programs r or red.
std::string short_name(const std::string& channel) {
  std::string name = lower(channel);
  for (const char* colour : {"red", "green", "blue", "alpha"})
    if (name == colour) return name.substr(0, 1);
  return name;
}

/// A layer from its channels by short name; false if they are no picture.
bool picture(const std::map<std::string, int>& channel, Layer& layer) {
  const auto has = [&](const char* name) { return channel.contains(name); };
  if (has("r") && has("g") && has("b")) {
    layer.kind = Layer::Kind::rgb;
    layer.channels = {channel.at("r"), channel.at("g"), channel.at("b")};
  } else if (has("y") && has("ry") && has("by")) {
    layer.kind = Layer::Kind::chroma;
    layer.channels = {channel.at("y"), channel.at("ry"), channel.at("by")};
  } else if (has("y") && !has("x")) {  // X, Y, Z are a vector's
    layer.kind = Layer::Kind::grey;
    layer.channels.fill(channel.at("y"));
  } else {
    return false;
  }
  layer.alpha = has("a") ? channel.at("a") : -1;
  return true;
}

std::string list(const std::vector<Layer>& layers) {
  std::vector<std::string> names;
  for (const Layer& layer : layers)
    if (!layer.address().empty()) names.push_back(layer.address());
  return fmt::format("{}", fmt::join(names, ", "));
}

template <class Condition>
std::vector<Layer> those(const std::vector<Layer>& layers, Condition condition) {
  std::vector<Layer> result;
  std::copy_if(layers.begin(), layers.end(), std::back_inserter(result), condition);
  return result;
}

/// Colours without a layer are what a file mainly shows, then the only ones in a layer, then the only grey ones.
Layer main_layer(const std::vector<Layer>& layers, const std::string& path) {
  for (const auto& candidates : {those(layers, [](const Layer& l) { return l.name.empty(); }),
                                 those(layers, [](const Layer& l) { return l.kind != Layer::Kind::grey; }), layers}) {
    if (candidates.size() == 1) return candidates[0];
    if (candidates.size() > 1)
      throw Error("{}: the image has several layers: {}; choose one, as layer = \"{}\"", path, list(candidates),
                  candidates[0].address());
  }
  throw Error("{}: the image has no channels R, G, B or Y", path);
}

}  // namespace

std::string Layer::address() const {
  return part_name.empty() || name.empty() ? part_name + name : part_name + "." + name;
}

std::vector<Layer> find_layers(int part, const std::string& part_name, const std::vector<std::string>& channels) {
  std::vector<std::string> names;  // in order
  std::map<std::string, std::map<std::string, int>> groups;
  for (int c = 0; c < int(channels.size()); ++c) {
    const std::size_t dot = channels[c].rfind('.');
    const std::string name = dot == std::string::npos ? "" : channels[c].substr(0, dot);
    if (!groups.contains(name)) names.push_back(name);
    groups[name].emplace(short_name(channels[c].substr(dot + 1)), c);  // npos + 1 = 0
  }
  std::vector<Layer> layers;
  for (const std::string& name : names)
    if (Layer layer{part, part_name, name}; picture(groups[name], layer)) layers.push_back(layer);
  return layers;
}

Layer choose_layer(const std::vector<Layer>& layers, const std::string& wanted, const std::string& path) {
  if (wanted.empty()) return main_layer(layers, path);
  const auto exact = those(layers, [&](const Layer& l) { return l.address() == wanted; });
  if (exact.size() == 1) return exact[0];
  const auto named = those(layers, [&](const Layer& l) { return l.name == wanted; });
  if (!named.empty()) return main_layer(named, path);
  const auto of_part = those(layers, [&](const Layer& l) { return l.part_name == wanted; });
  if (!of_part.empty()) return main_layer(of_part, path);
  const std::string others = list(layers);
  throw Error("{}: the image has no layer '{}' with channels R, G, B or Y; {}", path, wanted,
              others.empty() ? "its channels belong to no layer" : "there are " + others);
}

}  // namespace penumbra
