#include "harness/commands/templates.h"

#include <fstream>
#include <iterator>

#include "scenes/assets.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

std::string text_of(const std::string& name) {
  const std::string path = data_folder() + "/templates/" + name;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("{}: no such file; it comes with penumbra", path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The first line that begins so gets another beginning.
void replace_beginning(std::string& text, const std::string& beginning, const std::string& with) {
  const auto at = text.find("\n" + beginning);
  if (at == std::string::npos) throw Error("templates/scene.toml: no line begins with '{}'", beginning);
  text.replace(at + 1, beginning.size(), with);
}

/// A basic string of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    out += c;
  }
  return out + '"';
}

}  // namespace

std::string scene_template() {
  return text_of("scene.toml");
}

std::string scene_template(const std::string& mesh, bool closed) {
  std::string text = scene_template();
  replace_beginning(text, "mesh = \"torus-knot\"", "mesh = " + quoted(mesh));
  if (!closed) replace_beginning(text, "spheres = 64 ", "#spheres = 64");
  return text;
}

std::string suite_template() {
  return text_of("suite.toml");
}

}  // namespace penumbra
