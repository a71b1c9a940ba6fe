// The outside of glTF 2.0: its JSON, its buffers wherever they lie, its accessors as numbers.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/error.h"

namespace penumbra {

class GltfDocument {
 public:
  /// Throws Error naming `path` if it is no glTF. Buffers are read when an accessor asks for them.
  explicit GltfDocument(const std::string& path);

  const nlohmann::json& root() const { return root_; }
  bool version_1() const { return version_1_; }  ///< of another structure; then there is nothing else
  /// root()[array][index]. Throws Error if it is not there.
  const nlohmann::json& item(const char* array, std::size_t index) const;
  /// All numbers of an accessor of `type` ("SCALAR", "VEC3"), element by element, with stride, normalisation and sparse
  /// values applied. Throws Error if it reaches past its buffer.
  std::vector<double> numbers(std::size_t accessor, const std::string& type);

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw Error("{}: {}", path_, fmt::format(text, std::forward<Args>(args)...));
  }

 private:
  struct Layout {
    std::size_t count, components;
    int component_type;
    bool normalized;
  };
  std::string_view split_binary(std::string_view bytes);
  const std::string& buffer(std::size_t index);
  std::string external(const std::string& uri) const;
  std::string_view view(std::size_t index);
  void read_elements(std::size_t view_index, std::size_t offset, std::size_t stride, const Layout& layout, double* to);
  void apply_sparse(const nlohmann::json& sparse, const Layout& layout, std::vector<double>& numbers);

  std::string path_;
  nlohmann::json root_;
  std::string binary_;  // of a GLB
  std::map<std::size_t, std::string> buffers_;
  bool version_1_ = false;
};

}  // namespace penumbra
