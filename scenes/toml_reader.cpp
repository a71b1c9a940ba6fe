#include "scenes/toml_reader.h"

#include <cmath>
#include <filesystem>

#include <fmt/ranges.h>

namespace penumbra {

TomlReader::TomlReader(const toml::table& table, std::string file, std::string path)
    : table_(&table), file_(std::move(file)), path_(std::move(path)) {}

TomlReader TomlReader::open(const std::string& file) {
  if (!std::filesystem::exists(file)) throw Error("{}: no such file", file);
  try {
    auto owner = std::make_shared<const toml::table>(toml::parse_file(file));
    TomlReader reader(*owner, file, "");
    reader.owner_ = owner;
    return reader;
  } catch (const toml::parse_error& e) {
    throw Error("{}:{}: not valid TOML: {}", file, e.source().begin.line, std::string(e.description()));
  }
}

std::string TomlReader::where(const std::string& key) const {
  const toml::node* at = key.empty() ? nullptr : table_->get(key);
  const auto line = (at ? at->source() : table_->source()).begin.line;
  return fmt::format("{}:{}", file_, line);
}

void TomlReader::fail(const std::string& key, const std::string& what) const {
  throw Error("{}: key '{}' {}", where(key), name(key), what);
}

const toml::node* TomlReader::node(const std::string& key) {
  known_.insert(key);
  return table_->get(key);
}

bool TomlReader::has(const std::string& key) {
  return node(key) != nullptr;
}

std::optional<double> TomlReader::number(const std::string& key, double low, double high) {
  const toml::node* n = node(key);
  if (!n) return {};
  const auto value = n->value<double>();
  if (!n->is_number() || !value) fail(key, fmt::format("must be a number in [{}, {}]", low, high));
  if (!(*value >= low && *value <= high)) fail(key, fmt::format("is {}; allowed is [{}, {}]", *value, low, high));
  return value;
}

std::optional<int> TomlReader::integer(const std::string& key, int low, int high) {
  const toml::node* n = node(key);
  if (!n) return {};
  const auto value = n->value<int64_t>();
  if (!n->is_integer() || !value) fail(key, fmt::format("must be an integer in [{}, {}]", low, high));
  if (*value < low || *value > high) fail(key, fmt::format("is {}; allowed is [{}, {}]", *value, low, high));
  return int(*value);
}

std::optional<bool> TomlReader::boolean(const std::string& key) {
  const toml::node* n = node(key);
  if (!n) return {};
  if (!n->is_boolean()) fail(key, "must be true or false");
  return n->value<bool>();
}

std::optional<std::string> TomlReader::text(const std::string& key) {
  const toml::node* n = node(key);
  if (!n) return {};
  if (!n->is_string()) fail(key, "must be a string");
  return n->value<std::string>();
}

std::optional<vec3> TomlReader::vector(const std::string& key) {
  const auto v = point(key);
  if (v && glm::any(glm::greaterThan(glm::abs(*v), dvec3(1e30)))) fail(key, "must hold numbers in [-1e30, 1e30]");
  return v ? std::optional(vec3(*v)) : std::nullopt;
}

std::optional<dvec3> TomlReader::point(const std::string& key) {
  const toml::node* n = node(key);
  if (!n) return {};
  const toml::array* a = n->as_array();
  dvec3 v(0.0);
  bool good = a && a->size() == 3;
  for (int k = 0; good && k < 3; ++k) {
    const auto value = a->get(k)->value<double>();
    good = a->get(k)->is_number() && value && std::isfinite(*value);
    if (good) v[k] = *value;
  }
  if (!good) fail(key, "must be three finite numbers [x, y, z]");
  return v;
}

std::optional<TomlReader> TomlReader::table(const std::string& key) {
  const toml::node* n = node(key);
  if (!n) return {};
  if (!n->is_table()) fail(key, "must be a table");
  return TomlReader(*n->as_table(), file_, name(key));
}

std::vector<TomlReader> TomlReader::tables(const std::string& key) {
  const toml::node* n = node(key);
  if (!n) return {};
  const toml::array* a = n->as_array();
  if (!a || !a->is_array_of_tables()) fail(key, "must be an array of tables: [[" + name(key) + "]]");
  std::vector<TomlReader> readers;
  for (const toml::node& item : *a)
    readers.emplace_back(*item.as_table(), file_, fmt::format("{}[{}]", name(key), readers.size()));
  return readers;
}

void TomlReader::finish() const {
  for (const auto& [key, value] : *table_)
    if (!known_.contains(std::string(key.str())))
      throw Error("{}:{}: unknown key '{}'; allowed here: {}", file_, value.source().begin.line,
                  name(std::string(key.str())), fmt::join(known_, ", "));
}

}  // namespace penumbra
