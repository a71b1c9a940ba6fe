#include <bit>
#include <cmath>
#include <utility>

#include "scenes/error.h"
#include "scenes/import/readers.h"
#include "scenes/import/text.h"

namespace penumbra {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::float32;
  bool is_list = false;
  Type count_type = Type::uint8;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

std::size_t size_of(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<int>(type)];
}

std::optional<Type> type_named(std::string_view name) {
  constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::int8},      {"int8", Type::int8},      {"uchar", Type::uint8},   {"uint8", Type::uint8},
      {"short", Type::int16},    {"int16", Type::int16},    {"ushort", Type::uint16}, {"uint16", Type::uint16},
      {"int", Type::int32},      {"int32", Type::int32},    {"uint", Type::uint32},   {"uint32", Type::uint32},
      {"int64", Type::int64},    {"uint64", Type::uint64},  {"float", Type::float32}, {"float32", Type::float32},
      {"double", Type::float64}, {"float64", Type::float64}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return {};
}

/// One element: of each property its value or its list.
struct Row {
  std::vector<double> value;
  std::vector<std::vector<double>> list;
};

/// The numbers behind the header, one after the other.
class Values {
 public:
  enum class Format { ascii, little_endian, big_endian };
  Values(Format format, std::string_view rest) : rest_(rest), format_(format) {}

  /// Bytes that a value takes at least: a digit and a blank in ASCII.
  std::size_t least_size(Type type) const { return format_ == Format::ascii ? 2 : size_of(type); }
  bool has(std::uint64_t count, std::size_t size) const { return size == 0 || count <= (rest_.size() + 1) / size; }

  /// Nothing at the end of the data, or where there is no number.
  std::optional<double> next(Type type) {
    if (format_ == Format::ascii) return to_number(next_token(rest_));
    if (rest_.size() < size_of(type)) return {};
    unsigned char bytes[8];
    const std::size_t size = size_of(type);
    const bool reversed = (format_ == Format::little_endian) != (std::endian::native == std::endian::little);
    for (std::size_t b = 0; b < size; ++b) bytes[reversed ? size - 1 - b : b] = static_cast<unsigned char>(rest_[b]);
    rest_.remove_prefix(size);
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(bytes);
      case Type::uint8:
        return as<std::uint8_t>(bytes);
      case Type::int16:
        return as<std::int16_t>(bytes);
      case Type::uint16:
        return as<std::uint16_t>(bytes);
      case Type::int32:
        return as<std::int32_t>(bytes);
      case Type::uint32:
        return as<std::uint32_t>(bytes);
      case Type::int64:
        return as<std::int64_t>(bytes);
      case Type::uint64:
        return as<std::uint64_t>(bytes);
      case Type::float32:
        return as<float>(bytes);
      case Type::float64:
        return as<double>(bytes);
    }
    return {};
  }

 private:
  template <class T>
  static double as(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }

  std::string_view rest_;
  Format format_;
};

class PlyReader {
 public:
  explicit PlyReader(const std::string& path) : path_(path) {}
  RawMesh read(const std::string& bytes);

 private:
  Values read_header(std::string_view text);
  void read_header_line(std::string_view line);
  Property read_property(std::string_view line) const;
  double number(Values& values, const Element& element, std::uint64_t row, Type type) const;
  template <class Use>
  void read_rows(Values& values, const Element& element, Use use) const;
  void read_list(Values& values, const Element& element, std::uint64_t row, const Property& property,
                 std::vector<double>& list) const;
  void read_vertices(Values& values, const Element& element);
  void read_polygons(Values& values, const Element& element);
  void add_polygons();
  void add_strip(std::span<const double> indices);
  Corner corner(double index) const;
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw Error("{}: {}", path_, fmt::format(text, std::forward<Args>(args)...));
  }

  struct List {
    std::size_t first, size;
    bool strip;
  };
  const std::string& path_;
  std::string format_;
  std::vector<Element> elements_;
  std::vector<double> indices_;
  std::vector<List> lists_;
  bool has_normals_ = false, single_ = false;
  RawMesh mesh_;
};

RawMesh PlyReader::read(const std::string& bytes) {
  Values values = read_header(bytes);
  for (const Element& element : elements_) {
    if (element.name == "vertex") read_vertices(values, element);
    else if (element.name == "face" || element.name == "tristrips") read_polygons(values, element);
    else read_rows(values, element, [](const Row&) {});
  }
  add_polygons();
  if (single_) mesh_.spacing = float_spacing(mesh_.positions);
  return std::move(mesh_);
}

/// The data begin right behind the line end of end_header, which is that of the first line: a data byte that looks
/// like a further line end belongs to the data.
Values PlyReader::read_header(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (!text.starts_with("ply")) fail("does not begin with 'ply'; is it of another format? Save it as PLY again");
  const std::string_view end = text.substr(3).starts_with("\r\n") ? "\r\n"
                               : text.substr(3).starts_with('\r') ? "\r"
                                                                  : "\n";
  for (std::size_t at = text.find(end); at != text.npos; at = text.find(end)) {
    std::string_view line = text.substr(0, at);
    text.remove_prefix(at + end.size());
    std::string_view rest = line;
    if (next_token(rest) == "end_header") {
      if (format_ == "ascii") return {Values::Format::ascii, text};
      if (format_ == "binary_little_endian") return {Values::Format::little_endian, text};
      if (format_ == "binary_big_endian") return {Values::Format::big_endian, text};
      fail("format '{}' is not known; save it as ascii, binary_little_endian or binary_big_endian", format_);
    }
    read_header_line(line);
  }
  fail("the header has no end_header; the file is cut off or not PLY");
}

void PlyReader::read_header_line(std::string_view line) {
  const std::string_view keyword = next_token(line);
  if (keyword == "format") {
    format_ = next_token(line);
  } else if (keyword == "element") {
    Element element{std::string(next_token(line)), 0, {}};
    const std::string_view count = next_token(line);
    const auto n = to_number(count);
    if (!n || *n < 0.0 || *n > 1e18 || std::floor(*n) != *n)
      fail("'{}' is not a number of elements '{}'; repair the header", count, element.name);
    element.count = static_cast<std::uint64_t>(*n);
    elements_.push_back(std::move(element));
  } else if (keyword == "property") {
    if (elements_.empty()) fail("a property comes before every element; repair the header");
    elements_.back().properties.push_back(read_property(line));
  }
}

Property PlyReader::read_property(std::string_view line) const {
  const auto read_type = [&](std::string_view token) {
    const auto type = type_named(token);
    if (!type) fail("'{}' is not a type of properties; PLY has char to double", token);
    return *type;
  };
  Property property;
  std::string_view token = next_token(line);
  property.is_list = token == "list";
  if (property.is_list) property.count_type = read_type(next_token(line)), token = next_token(line);
  property.type = read_type(token);
  property.name = next_token(line);
  return property;
}

double PlyReader::number(Values& values, const Element& element, std::uint64_t row, Type type) const {
  const auto value = values.next(type);
  if (!value)
    fail("ends, or has no number, in '{}' {} of {}; the file is cut off or damaged: copy or save it again",
         element.name, row + 1, element.count);
  return *value;
}

void PlyReader::read_list(Values& values, const Element& element, std::uint64_t row, const Property& property,
                          std::vector<double>& list) const {
  const double size = number(values, element, row, property.count_type);
  if (!(size >= 0.0 && size < 1e15 && std::floor(size) == size) ||
      !values.has(static_cast<std::uint64_t>(size), values.least_size(property.type)))
    fail(
        "'{}' {} of {} has a list of {} values, more than the file holds; it is cut off or damaged: copy or save it "
        "again",
        element.name, row + 1, element.count, size);
  list.resize(static_cast<std::size_t>(size));
  for (double& value : list) value = number(values, element, row, property.type);
}

template <class Use>
void PlyReader::read_rows(Values& values, const Element& element, Use use) const {
  std::size_t least = 0;
  for (const Property& p : element.properties) least += values.least_size(p.is_list ? p.count_type : p.type);
  if (least == 0) return;  // no properties, no data
  if (!values.has(element.count, least))
    fail("has too few bytes for {} of '{}'; the file is cut off or its header wrong: copy or save it again",
         element.count, element.name);
  const std::size_t properties = element.properties.size();
  Row row{std::vector<double>(properties), std::vector<std::vector<double>>(properties)};
  for (std::uint64_t r = 0; r < element.count; ++r) {
    for (std::size_t p = 0; p < properties; ++p) {
      const Property& property = element.properties[p];
      if (property.is_list) read_list(values, element, r, property, row.list[p]);
      else row.value[p] = number(values, element, r, property.type);
    }
    use(row);
  }
}

void PlyReader::read_vertices(Values& values, const Element& element) {
  constexpr std::string_view names[] = {"x", "y", "z", "nx", "ny", "nz"};
  constexpr std::size_t none = ~std::size_t(0);
  std::array<std::size_t, 6> at;
  at.fill(none);
  for (std::size_t p = 0; p < element.properties.size(); ++p)
    for (std::size_t n = 0; n < 6; ++n)
      if (element.properties[p].name == names[n] && !element.properties[p].is_list) at[n] = p;
  if (at[0] == none || at[1] == none || at[2] == none) fail("its vertices have no x, y and z; save positions with it");
  has_normals_ = at[3] != none && at[4] != none && at[5] != none;
  for (int n = 0; n < 3; ++n)  // text is read with all its digits, whatever the header says
    single_ |= format_ != "ascii" && element.properties[at[n]].type == Type::float32;
  read_rows(values, element, [&](const Row& row) {
    mesh_.positions.emplace_back(row.value[at[0]], row.value[at[1]], row.value[at[2]]);
    if (has_normals_) mesh_.normals.emplace_back(row.value[at[3]], row.value[at[4]], row.value[at[5]]);
  });
}

void PlyReader::read_polygons(Values& values, const Element& element) {
  std::size_t at = 0;
  const auto& properties = element.properties;
  while (at < properties.size() && !(properties[at].is_list && properties[at].name.starts_with("vertex_ind"))) ++at;
  if (at == properties.size()) fail("'{}' has no list vertex_indices; save the mesh with faces", element.name);
  read_rows(values, element, [&](const Row& row) {
    lists_.push_back({indices_.size(), row.list[at].size(), element.name == "tristrips"});
    indices_.insert(indices_.end(), row.list[at].begin(), row.list[at].end());
  });
}

Corner PlyReader::corner(double index) const {
  if (!(index >= 0.0 && index < double(mesh_.positions.size()) && std::floor(index) == index))
    fail("a face names vertex {}, of {} that count from 0; repair the mesh and save it again", index,
         mesh_.positions.size());
  const auto i = static_cast<unsigned>(index);
  return {i, has_normals_ ? i : no_normal};
}

/// Triangles of a strip; -1 begins another.
void PlyReader::add_strip(std::span<const double> indices) {
  std::vector<Corner> strip;
  for (const double index : indices) {
    if (index == -1.0) {
      strip.clear();
      continue;
    }
    strip.push_back(corner(index));
    const std::size_t n = strip.size();
    if (n >= 3) mesh_.add_polygon(std::span(strip).last(3), has_normals_, n % 2 == 0);
  }
}

void PlyReader::add_polygons() {
  std::vector<Corner> polygon;
  for (const List& list : lists_) {
    const auto indices = std::span<const double>(indices_).subspan(list.first, list.size);
    if (list.strip) {
      add_strip(indices);
      continue;
    }
    polygon.clear();
    for (const double index : indices) polygon.push_back(corner(index));
    mesh_.add_polygon(polygon, has_normals_);
  }
}

}  // namespace

RawMesh read_ply(const std::string& path, Outbox&) {
  return PlyReader(path).read(read_bytes(path));
}

}  // namespace penumbra
