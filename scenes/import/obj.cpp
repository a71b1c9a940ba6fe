#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_map>

#include "scenes/error.h"
#include "scenes/import/polygon.h"
#include "scenes/import/readers.h"
#include "scenes/import/text.h"

namespace penumbra {
namespace {

constexpr int nothing_said = -1, flat = 0;

struct Face {
  std::size_t first_corner, line;
  int smoothing;  // group, flat, or nothing_said before the first `s`
};

class ObjReader {
 public:
  ObjReader(const std::string& path, Outbox& says) : path_(path), says_(says) {}
  RawMesh read(std::string_view text);

 private:
  void read_line(std::string_view line);
  dvec3 read_vector(std::string_view line, const char* what);
  void read_position(std::string_view line);
  void read_face(std::string_view line);
  void read_smoothing(std::string_view line);
  Corner read_corner(std::string_view token);
  unsigned index(std::string_view token, std::size_t size, const char* what);
  void check(const Face& face, std::span<const Corner> corners) const;
  bool groups_matter() const;
  void smooth_groups();
  void add_faces();
  std::span<Corner> corners_of(std::size_t face);
  std::vector<dvec3> points_of(std::span<const Corner> corners) const;
  template <class... Args>
  [[noreturn]] void fail(std::size_t line, fmt::format_string<Args...> text, Args&&... args) const {
    throw Error("{}:{}: {}", path_, line, fmt::format(text, std::forward<Args>(args)...));
  }

  const std::string& path_;
  Outbox& says_;
  RawMesh mesh_;
  std::vector<Corner> corners_;
  std::vector<Face> faces_;
  int smoothing_ = nothing_said;
  std::size_t line_ = 0, weights_ = 0, curves_ = 0;
};

RawMesh ObjReader::read(std::string_view text) {
  Lines lines(text);
  for (std::string_view line; lines.next(line);) {
    line_ = lines.number();
    read_line(line);
  }
  add_faces();
  if (weights_ > 0)
    says_.warn(fmt::format("{}: {} vertices have a weight (a fourth number); it concerns curves and is left out", path_,
                           weights_));
  if (curves_ > 0)
    says_.warn(fmt::format("{}: {} free-form curves and surfaces are left out; save them as polygons", path_, curves_));
  return std::move(mesh_);
}

void ObjReader::read_line(std::string_view line) {
  const std::string_view keyword = next_token(line);
  if (keyword == "v") read_position(line);
  else if (keyword == "vn") mesh_.normals.push_back(read_vector(line, "normal"));
  else if (keyword == "f" || keyword == "fo") read_face(line);
  else if (keyword == "s") read_smoothing(line);
  else if (keyword == "surf" || keyword == "curv") ++curves_;
}

dvec3 ObjReader::read_vector(std::string_view line, const char* what) {
  dvec3 v(0.0);
  for (int c = 0; c < 3; ++c) {
    const std::string_view token = next_token(line);
    if (token.empty()) fail(line_, "a {} needs three numbers", what);
    const auto number = to_number(token);
    if (!number) fail(line_, "'{}' is not a number; write coordinates like -1.5e-3, with a point", token);
    v[c] = *number;
  }
  return v;
}

void ObjReader::read_position(std::string_view line) {
  mesh_.positions.push_back(read_vector(line, "vertex"));
  for (int c = 0; c < 3; ++c) next_token(line);
  const std::string_view fourth = next_token(line);
  std::size_t numbers = fourth.empty() ? 0 : 1;
  while (!next_token(line).empty()) ++numbers;
  // x y z w, or x y z w r g b; x y z r g b are colours
  if (numbers == 1 || numbers == 4) weights_ += to_number(fourth).value_or(1.0) != 1.0;
}

unsigned ObjReader::index(std::string_view token, std::size_t size, const char* what) {
  long long i = 0;
  const bool sign = token.starts_with('+');
  const auto [end, fault] = std::from_chars(token.data() + sign, token.data() + token.size(), i);
  if (fault != std::errc() || end != token.data() + token.size() || i == 0)
    fail(line_, "'{}' is not the number of a {}; they count from 1, or back from -1", token, what);
  if (i < 0) i += static_cast<long long>(size) + 1;
  if (i < 1 || i >= no_normal) fail(line_, "{} {} is out of range; {} come before this line", what, token, size);
  return static_cast<unsigned>(i - 1);
}

/// v, v/vt, v//vn, v/vt/vn
Corner ObjReader::read_corner(std::string_view token) {
  const std::size_t slash = token.find('/');
  Corner corner{index(token.substr(0, slash), mesh_.positions.size(), "vertex")};
  if (slash == token.npos) return corner;
  const std::size_t second = token.find('/', slash + 1);
  if (second != token.npos && second + 1 < token.size())
    corner.normal = index(token.substr(second + 1), mesh_.normals.size(), "normal");
  return corner;
}

void ObjReader::read_face(std::string_view line) {
  faces_.push_back({corners_.size(), line_, smoothing_});
  for (std::string_view token; !(token = next_token(line)).empty();) corners_.push_back(read_corner(token));
}

void ObjReader::read_smoothing(std::string_view line) {
  const std::string_view token = next_token(line);
  const auto group = to_number(token);
  smoothing_ = token == "off" ? flat : group && *group >= 0.0 && *group < 1e9 ? static_cast<int>(*group) : 1;
}

std::span<Corner> ObjReader::corners_of(std::size_t face) {
  const std::size_t end = face + 1 < faces_.size() ? faces_[face + 1].first_corner : corners_.size();
  return std::span(corners_).subspan(faces_[face].first_corner, end - faces_[face].first_corner);
}

std::vector<dvec3> ObjReader::points_of(std::span<const Corner> corners) const {
  std::vector<dvec3> points;
  for (const Corner& corner : corners) points.push_back(mesh_.positions[corner.position]);
  return points;
}

void ObjReader::check(const Face& face, std::span<const Corner> corners) const {
  for (const Corner& corner : corners) {
    if (corner.position >= mesh_.positions.size())
      fail(face.line, "vertex {} is out of range; the file has {}", corner.position + 1, mesh_.positions.size());
    if (corner.normal != no_normal && corner.normal >= mesh_.normals.size())
      fail(face.line, "normal {} is out of range; the file has {}", corner.normal + 1, mesh_.normals.size());
    const dvec3& p = mesh_.positions[corner.position];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      fail(face.line, "vertex {} is not finite ({}, {}, {}); repair the mesh and save it again", corner.position + 1,
           p.x, p.y, p.z);
  }
}

bool ObjReader::groups_matter() const {
  bool differ = false;
  for (const Face& face : faces_) differ |= face.smoothing == flat || face.smoothing != faces_[0].smoothing;
  return differ && std::any_of(corners_.begin(), corners_.end(), [](Corner c) { return c.normal == no_normal; });
}

/// Gives every corner without a normal the one that `s` asks for: the face's, or the area-weighted mean of those faces
/// around its place that are of its group.
void ObjReader::smooth_groups() {
  const std::vector<unsigned> place = equal_places(mesh_.positions);
  std::unordered_map<std::uint64_t, unsigned> of_place_and_group;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto corners = corners_of(f);
    if (corners.size() < 3) continue;
    const dvec3 normal = polygon_normal(points_of(corners));
    const int group = faces_[f].smoothing;
    if (group == flat) mesh_.normals.push_back(normal);
    for (Corner& corner : corners) {
      auto smooth = static_cast<unsigned>(mesh_.normals.size()) - 1;
      if (group != flat) {
        const std::uint64_t key = std::uint64_t(place[corner.position]) << 32 | static_cast<unsigned>(group);
        const auto [at, is_new] = of_place_and_group.try_emplace(key, smooth + 1);
        if (is_new) mesh_.normals.emplace_back(0.0);
        smooth = at->second;
        mesh_.normals[smooth] += normal;
      }
      if (corner.normal == no_normal) corner.normal = smooth;
    }
  }
}

void ObjReader::add_faces() {
  for (std::size_t f = 0; f < faces_.size(); ++f) check(faces_[f], corners_of(f));
  const std::size_t given = mesh_.normals.size();
  if (groups_matter()) smooth_groups();  // else the mesh is smooth as a whole where it has no normals
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto corners = corners_of(f);
    const bool from_file = std::any_of(corners.begin(), corners.end(), [&](Corner c) { return c.normal < given; });
    mesh_.add_polygon(corners, from_file);
  }
}

}  // namespace

RawMesh read_obj(const std::string& path, Outbox& says) {
  const std::string bytes = read_bytes(path);
  return ObjReader(path, says).read(text_of(bytes, path));
}

}  // namespace penumbra
