#include "scenes/import/import.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "scenes/error.h"
#include "scenes/import/readers.h"
#include "scenes/import/text.h"

namespace penumbra {
namespace {

using Reader = RawMesh (*)(const std::string& path, Outbox& says);

std::string beginning(const std::string& path, std::size_t size) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(size, '\0');
  in.read(bytes.data(), std::streamsize(size));
  bytes.resize(std::size_t(std::max<std::streamsize>(in.gcount(), 0)));
  return bytes;
}

/// Text with lines that begin with `v` and `f`, as OBJ files without their extension have.
bool looks_like_obj(std::string_view text) {
  bool vertex = false, face = false;
  Lines lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view keyword = next_token(line);
    vertex |= keyword == "v", face |= vertex && keyword == "f";
  }
  return face;
}

/// By what the file begins with, where that tells; else by its extension.
Reader reader_for(const std::string& path) {
  const std::string bytes = beginning(path, 1 << 16);
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));

  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return read_ply;
  if (text.starts_with("glTF")) return read_gltf;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool json = first != text.npos && text[first] == '{';
  if (extension == ".gltf" || extension == ".glb" || (json && extension.empty())) return read_gltf;
  if (extension == ".obj") return read_obj;
  if (extension == ".ply") return read_ply;
  if ((extension.empty() || extension == ".txt") && looks_like_obj(text)) return read_obj;
  return read_with_assimp;
}

}  // namespace

ImportedMesh import_mesh(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such mesh file", path);
  if (!std::filesystem::is_regular_file(path)) throw Error("{}: not a file; name a mesh file in it", path);
  if (std::filesystem::file_size(path) == 0) throw Error("{}: the file is empty; save the mesh again", path);
  const auto read = [&](Outbox& out) {
    const ImportedMesh mesh = assemble(reader_for(path)(path, out), path, out);
    out.put(mesh.positions), out.put(mesh.triangles), out.put(mesh.normals);
  };
  Inbox box = guarded(path, "open it in a mesh program and save it again as OBJ, PLY or glTF", read);
  ImportedMesh mesh;
  mesh.positions = box.take<dvec3>();
  mesh.triangles = box.take<uvec3>();
  mesh.normals = box.take<vec3>();
  return mesh;
}

}  // namespace penumbra
