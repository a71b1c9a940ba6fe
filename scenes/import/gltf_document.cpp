#include "scenes/import/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>

#include "scenes/import/text.h"

namespace penumbra {
namespace {

using nlohmann::json;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t b = 0; b < 4; ++b) value |= std::uint32_t(static_cast<unsigned char>(bytes[at + b])) << 8 * b;
  return value;
}

std::string percent_decoded(std::string_view uri) {
  const auto digit = [](char c) {
    const std::size_t at = std::string_view("0123456789abcdef0123456789ABCDEF").find(c);
    return at == std::string_view::npos ? -1 : int(at % 16);
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool coded = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    out += coded ? static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2])) : uri[i];
    if (coded) i += 2;
  }
  return out;
}

/// RFC 4648, with either alphabet; nothing if a character is of neither.
std::optional<std::string> base64_decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    int value = 0;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    else if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    else if (c >= '0' && c <= '9') value = c - '0' + 52;
    else if (c == '+' || c == '-') value = 62;
    else if (c == '/' || c == '_') value = 63;
    else if (c == '\n' || c == '\r' || c == ' ') continue;
    else return {};
    bits = bits << 6 | std::uint32_t(value);
    if ((count += 6) >= 8) out += static_cast<char>(bits >> (count -= 8) & 0xffu);
  }
  return out;
}

constexpr int float_type = 5126;

std::size_t component_size(int type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case float_type:
      return 4;
    default:
      return 0;
  }
}

template <class T>
double component_as(const char* at, bool normalized) {
  T value;
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::is_integral_v<T>)
    if (normalized) return std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0);
  return double(value);
}

double component(const char* at, int type, bool normalized) {
  switch (type) {
    case 5120:
      return component_as<std::int8_t>(at, normalized);
    case 5121:
      return component_as<std::uint8_t>(at, normalized);
    case 5122:
      return component_as<std::int16_t>(at, normalized);
    case 5123:
      return component_as<std::uint16_t>(at, normalized);
    case 5125:
      return component_as<std::uint32_t>(at, normalized);
    default:
      return component_as<float>(at, normalized);
  }
}

}  // namespace

GltfDocument::GltfDocument(const std::string& path) : path_(path) {
  const std::string bytes = read_bytes(path);
  const std::string_view text = bytes.starts_with("glTF") ? split_binary(bytes) : text_of(bytes, path);
  if (version_1_) return;
  root_ = json::parse(text, nullptr, false);
  if (!root_.is_object()) fail("is not glTF: its JSON cannot be read; save it again as glTF or GLB");
  const json about = root_.value("asset", json::object()).value("version", json());
  const std::string version = about.is_string() ? about.get<std::string>() : about.dump();
  version_1_ = version.starts_with("1") || root_.value("meshes", json()).is_object();
  if (!version_1_ && !version.starts_with("2.")) fail("glTF of version {} is not known; save it as glTF 2.0", version);
}

/// The JSON of a GLB; keeps its binary chunk.
std::string_view GltfDocument::split_binary(std::string_view bytes) {
  if (bytes.size() >= 8) version_1_ = word(bytes, 4) == 1;
  if (version_1_) return {};
  std::string_view text;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t size = word(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (size > bytes.size() - at - 8) fail("is cut off in the chunk at byte {}; copy or save it again", at);
    if (type == "JSON" && text.empty()) text = bytes.substr(at + 8, size);
    else if (type == std::string_view("BIN\0", 4) && binary_.empty()) binary_ = bytes.substr(at + 8, size);
    at += 8 + size;
  }
  return text;
}

const json& GltfDocument::item(const char* array, std::size_t index) const {
  const auto found = root_.find(array);
  if (found == root_.end() || !found->is_array() || index >= found->size())
    fail("names {}[{}], which it does not hold; save it again", array, index);
  return (*found)[index];
}

std::string GltfDocument::external(const std::string& uri) const {
  const auto folder = std::filesystem::path(path_).parent_path();
  for (const std::string& name : {percent_decoded(uri), uri})
    if (std::filesystem::is_regular_file(folder / name)) return read_bytes((folder / name).string());
  fail("its buffer '{}' is missing; put that file beside it", percent_decoded(uri).substr(0, 200));
}

const std::string& GltfDocument::buffer(std::size_t index) {
  const auto [at, is_new] = buffers_.try_emplace(index);
  std::string& data = at->second;
  if (!is_new) return data;
  const json& about = item("buffers", index);
  const std::string uri = about.value("uri", "");
  if (uri.empty()) {
    if (index != 0 || binary_.empty()) fail("buffer {} has no data; save it again without compression", index);
    data = std::move(binary_);
  } else if (uri.starts_with("data:")) {
    const std::size_t comma = std::min(uri.find(','), uri.size() - 1);
    const std::string_view head = std::string_view(uri).substr(0, comma),
                           body = std::string_view(uri).substr(comma + 1);
    const auto decoded = head.ends_with(";base64") ? base64_decoded(percent_decoded(body)) : percent_decoded(body);
    if (!decoded) fail("the data of buffer {} are not base64; save it again", index);
    data = *decoded;
  } else {
    data = external(uri);
  }
  const std::size_t size = about.at("byteLength").get<std::size_t>();
  if (size > data.size())
    fail("buffer {} has {} bytes where {} are said; it is cut off: copy or save it again", index, data.size(), size);
  return data;
}

std::string_view GltfDocument::view(std::size_t index) {
  const json& about = item("bufferViews", index);
  const std::string_view data = buffer(about.at("buffer").get<std::size_t>());
  const auto offset = about.value("byteOffset", std::size_t(0)), size = about.at("byteLength").get<std::size_t>();
  if (offset > data.size() || size > data.size() - offset)
    fail("bufferViews[{}] reaches past its buffer; it is damaged: save it again", index);
  return data.substr(offset, size);
}

void GltfDocument::read_elements(std::size_t view_index, std::size_t offset, std::size_t stride, const Layout& layout,
                                 double* to) {
  const std::string_view data = view(view_index);
  const std::size_t size = component_size(layout.component_type), element = size * layout.components;
  if (size == 0) fail("components of type {} are not known; save it again", layout.component_type);
  if (stride == 0) stride = element;
  if (layout.count == 0) return;
  if (offset > data.size() || element > data.size() - offset ||
      layout.count - 1 > (data.size() - offset - element) / stride)
    fail("an accessor of {} elements reaches past bufferViews[{}]; it is damaged: save it again", layout.count,
         view_index);
  for (std::size_t i = 0; i < layout.count; ++i)
    for (std::size_t c = 0; c < layout.components; ++c)
      *to++ = component(data.data() + offset + i * stride + c * size, layout.component_type, layout.normalized);
}

void GltfDocument::apply_sparse(const json& sparse, const Layout& layout, std::vector<double>& numbers) {
  const json &indices = sparse.at("indices"), &values = sparse.at("values");
  const auto count = sparse.at("count").get<std::size_t>();
  if (count > layout.count) fail("an accessor replaces {} of {} elements; save it again", count, layout.count);
  std::vector<double> at(count), with(count * layout.components);
  read_elements(indices.at("bufferView"), indices.value("byteOffset", std::size_t(0)), 0,
                {count, 1, indices.at("componentType"), false}, at.data());
  read_elements(values.at("bufferView"), values.value("byteOffset", std::size_t(0)), 0,
                {count, layout.components, layout.component_type, layout.normalized}, with.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (!(at[i] < double(layout.count)))
      fail("an accessor replaces element {} of {}; save it again", at[i], layout.count);
    std::copy_n(with.begin() + std::ptrdiff_t(i * layout.components), layout.components,
                numbers.begin() + std::ptrdiff_t(std::size_t(at[i]) * layout.components));
  }
}

std::vector<double> GltfDocument::numbers(std::size_t accessor, const std::string& type) {
  const json& about = item("accessors", accessor);
  if (about.value("type", "") != type)
    fail("accessors[{}] holds {} where {} is needed; save it again", accessor, about.value("type", "nothing"), type);
  const Layout layout{about.at("count"), type == "VEC3" ? 3u : 1u, about.at("componentType"),
                      about.value("normalized", false)};
  const auto from = about.find("bufferView");
  std::vector<double> out;
  if (from != about.end()) {
    const std::size_t index = *from;
    if (layout.count > view(index).size())
      fail("accessors[{}] has {} elements, more than its buffer; it is damaged: save it again", accessor, layout.count);
    out.resize(layout.count * layout.components);
    read_elements(index, about.value("byteOffset", std::size_t(0)),
                  item("bufferViews", index).value("byteStride", std::size_t(0)), layout, out.data());
  } else {
    out.resize(layout.count * layout.components);
  }
  if (about.contains("sparse")) apply_sparse(about["sparse"], layout, out);
  return out;
}

}  // namespace penumbra
