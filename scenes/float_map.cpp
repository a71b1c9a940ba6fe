#include "scenes/float_map.h"

#include <bit>

#include "scenes/storage/atomic_write.h"

namespace penumbra {

void save_pfm(const std::string& path, const Image& image) {
  static_assert(std::endian::native == std::endian::little && sizeof(vec3) == 3 * sizeof(float));
  write_atomically(path, [&](std::ostream& out) {
    out << "PF\n" << image.width << " " << image.height << "\n-1.0\n";
    for (int y = image.height - 1; y >= 0; --y)
      out.write(reinterpret_cast<const char*>(&image.pixels[std::size_t(y) * image.width]),
                std::streamsize(std::size_t(image.width) * sizeof(vec3)));
  });
}

}  // namespace penumbra
