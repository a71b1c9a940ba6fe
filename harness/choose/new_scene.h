// A scene file for a mesh that somebody brings: on the ground, under one light, with receivers in proportion.
#pragma once

#include <string>

namespace penumbra {

/// A mesh and a light as the command line names them. Empty texts: not given.
struct SceneRequest {
  std::string mesh;      ///< shape, asset or file
  std::string light;     ///< environment: name or image file; without lamp and light "sun-sky"
  std::string lamp;      ///< "WxH@x,y,z" or "R@x,y,z"
  std::string up = "y";  ///< "y" or "z": the mesh's own
  double height = 0.0;   ///< that the mesh is scaled to, m; 0: its own
  int resolution = 128;  ///< receivers along an edge of the plane
  bool moving = false;   ///< twists
};

/// A rectangle W x H or a disc of radius R, m, that shines from `centre` towards the middle of a mesh of this height.
struct Lamp {
  double width = 0.0, height = 0.0;  ///< rectangle
  double radius = 0.0;               ///< disc, where it is not 0
  double x = 0.0, y = 0.0, z = 0.0;
};

/// Throws Error saying what is allowed: sizes above 0, finite places.
Lamp parse_lamp(const std::string& text);

/// Is this a shipped scene or a scene file? If not, a mesh is meant.
bool names_scene(const std::string& subject);

/// Writes FOLDER/scene.toml and returns its path. The mesh stands on y = 0 about x = z = 0; the plane of receivers
/// reaches four fifths of its height beyond it, where shadows of a light at 45 degrees and more end. Throws Error if
/// mesh or light are not there.
std::string write_scene(const SceneRequest& request, const std::string& folder);

}  // namespace penumbra
