// The folder where results that are dear to compute wait for the next run.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenes/storage/atomic_write.h"

namespace penumbra {

/// $PENUMBRA_CACHE, else $XDG_CACHE_HOME/penumbra, else ~/.cache/penumbra.
std::string cache_folder();

/// A result that the folder may hold, in a file that is named by the content key of all that the result depends on.
struct CacheEntry {
  std::string name;                                   ///< of the file
  std::string cache;                                  ///< "reference cache": what warnings begin with
  std::string instead;                                ///< "computing it anew": what is done about a damaged file
  std::function<void(const std::string& line)> warn;  ///< told of a file that is damaged, or cannot be written

  std::string path() const { return cache_folder() + "/" + name; }
  bool exists() const;  ///< is there a file? it is not looked into

  /// What `load` (path -> result) makes of the file; empty if there is none. One that it throws at is warned of.
  template <class Load>
  auto look_up(Load load) const -> std::optional<decltype(load(path()))> {
    if (!exists()) return {};
    try {
      return load(path());
    } catch (const std::exception& e) {
      warn(cache + ": " + e.what() + "; " + instead);
      return {};
    }
  }

  /// What look_up() finds, or else what `compute` returns, which `store` (path, result) keeps for the next run; a
  /// result that cannot be kept costs a warning. Several threads and processes may ask at once if `store` is atomic.
  template <class Load, class Compute, class Store>
  auto get(Load load, Compute compute, Store store) const -> decltype(load(path())) {
    if (auto found = look_up(load)) return std::move(*found);
    auto result = compute();
    try {
      make_folder(cache_folder());
      store(path(), result);
    } catch (const std::exception& e) {
      warn(cache + ": " + e.what() + "; going on without");
    }
    return result;
  }
};

}  // namespace penumbra
