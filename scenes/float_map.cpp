#include "scenes/float_map.h"

#include <bit>
#include <filesystem>
#include <fstream>

#include "scenes/error.h"

namespace penumbra {

void save_pfm(const std::string& path, const Image& image) {
  static_assert(std::endian::native == std::endian::little && sizeof(vec3) == 3 * sizeof(float));
  const std::string partial = path + ".partial";
  std::ofstream out(partial, std::ios::binary);
  out << "PF\n" << image.width << " " << image.height << "\n-1.0\n";
  for (int y = image.height - 1; y >= 0; --y)
    out.write(reinterpret_cast<const char*>(&image.pixels[std::size_t(y) * image.width]),
              std::streamsize(std::size_t(image.width) * sizeof(vec3)));
  out.close();
  if (!out) throw Error("{}: cannot be written", path);
  std::filesystem::rename(partial, path);
}

}  // namespace penumbra
