// toml++ tables read strictly: every key is asked for, whatever is left over is an error with file, line and key.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include "scenes/error.h"
#include "scenes/math.h"

namespace penumbra {

class TomlReader {
 public:
  /// Parses a file. Throws Error with file and line if it is missing or not TOML.
  static TomlReader open(const std::string& file);
  /// A table that belongs to `file`, e.g. an element of an array of tables.
  TomlReader(const toml::table& table, std::string file, std::string path);

  bool has(const std::string& key);
  std::optional<double> number(const std::string& key, double low, double high);
  std::optional<int> integer(const std::string& key, int low, int high);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<vec3> vector(const std::string& key);
  std::optional<dvec3> point(const std::string& key);  ///< the same in double: a place may be far from zero
  std::optional<TomlReader> table(const std::string& key);
  std::vector<TomlReader> tables(const std::string& key);
  const toml::node* node(const std::string& key);
  const toml::table& raw() const { return *table_; }
  const std::string& file() const { return file_; }

  /// Marks the key as known without reading it.
  void allow(const std::string& key) { known_.insert(key); }
  template <class T>
  T required(const std::string& key, const std::optional<T>& value, const char* meaning) const {
    if (!value) throw Error("{}: key '{}' is missing: {}", where(), name(key), meaning);
    return *value;
  }
  /// "file:line" of a key, or of the table.
  std::string where(const std::string& key = "") const;
  std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// Throws Error for the first key that was never asked for, listing those that were.
  void finish() const;

 private:
  std::shared_ptr<const toml::table> owner_;  // keeps a parsed file alive
  const toml::table* table_;
  std::string file_, path_;
  std::set<std::string> known_;
};

}  // namespace penumbra
