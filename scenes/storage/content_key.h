// The names of stored results, which follow from all that the results depend on, and the checksums inside of them.
#pragma once

#include <OpenImageIO/hash.h>

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace penumbra {

/// SHA-1 over everything that a stored result depends on.
class ContentHash {
 public:
  ContentHash() = default;
  /// Begins with the version of an algorithm or format: raise it when that changes, and what was stored before is never
  /// looked at again.
  explicit ContentHash(int version) { add_value(version); }

  template <class T>
  void add(const std::vector<T>& values) {
    add_bytes(values.data(), values.size(), sizeof(T));
  }
  void add(std::string_view text) { add_bytes(text.data(), text.size(), 1); }
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    sha_.append(&value, sizeof value);
  }
  std::string digest() { return sha_.digest(); }

 private:
  void add_bytes(const void* data, std::uint64_t count, std::size_t size) {
    add_value(count);
    sha_.append(data, count * size);
  }

  OIIO::SHA1 sha_;
};

/// SHA-1 of the values alone: kept beside them, it tells whether they are what was written.
template <class T>
std::string checksum(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return OIIO::SHA1::digest(values.data(), values.size() * sizeof(T));
}

}  // namespace penumbra
