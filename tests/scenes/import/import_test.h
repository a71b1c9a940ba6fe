// What tests of importers share.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "scenes/import/import.h"
#include "tests/support.h"

namespace penumbra::test {

using testing::HasSubstr;

inline double volume(const ImportedMesh& mesh) {
  double sum = 0.0;
  const dvec3 o = mesh.positions[0];
  for (const uvec3& t : mesh.triangles)
    sum += glm::dot(mesh.positions[t.x] - o, glm::cross(mesh.positions[t.y] - o, mesh.positions[t.z] - o)) / 6.0;
  return sum;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

class Import : public testing::Test {
 protected:
  ImportedMesh read(const std::string& name, const std::string& text) { return import_mesh(folder.write(name, text)); }
  std::string error(const std::string& name, const std::string& text) {
    return error_of([&] { read(name, text); });
  }
  /// What reading logs.
  std::string log(const std::string& name, const std::string& text) {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    read(name, text);
    return testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  }
  TemporaryFolder folder;
};

/// The box that the files of these tests hold: 0.6 wide, on the ground.
inline void expect_box(const ImportedMesh& mesh, const std::string& what, std::size_t positions = 8) {
  EXPECT_EQ(mesh.positions.size(), positions) << what;
  EXPECT_EQ(mesh.triangles.size(), 12u) << what;
  EXPECT_NEAR(volume(mesh), 0.216, 1e-7) << what;
}

/// As many normals as positions, all along an axis and outward.
inline void expect_flat(const ImportedMesh& mesh, const std::string& what) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << what;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const vec3 n = mesh.normals[i];
    EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0f, 1e-6f) << what;
    EXPECT_GT(glm::dot(dvec3(n), mesh.positions[i] - dvec3(0.0, 0.3, 0.0)), 0.2) << what;
  }
}

/// Corners and quadrilaterals of the box, from 0.
inline constexpr double box_corners[8][3] = {{-0.3, 0, -0.3}, {0.3, 0, -0.3}, {-0.3, 0.6, -0.3}, {0.3, 0.6, -0.3},
                                             {-0.3, 0, 0.3},  {0.3, 0, 0.3},  {-0.3, 0.6, 0.3},  {0.3, 0.6, 0.3}};
inline constexpr unsigned box_faces[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                             {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};

}  // namespace penumbra::test
