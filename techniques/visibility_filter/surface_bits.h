// Bits of surfaces (surface_rows.h) that own their words.
#pragma once

#include <optional>

#include "techniques/visibility_filter/surface_rows.h"

namespace penumbra::visibility_filter {

class SurfaceBits : public SurfaceRows<std::uint64_t*> {
 public:
  SurfaceBits() = default;
  SurfaceBits(const SurfaceBits&) = delete;
  SurfaceBits& operator=(const SurfaceBits&) = delete;

  /// Takes in a map. Pixels whose windows of up to 2 r + 1 are all lit or all dark are known from then on. Without
  /// epsilon there are no links: for count_all() alone.
  void set(const PixelMap& map, std::optional<float> epsilon, int r);

  /// Do windows of up to 2 r + 1 about the pixel hold both?
  bool is_mixed(int x, int y) const { return bit(mixed, x, y); }

  std::size_t bytes() const { return memory_.capacity() * sizeof(std::uint64_t); }

 private:
  void place(int wide, int high);
  void set_row(const PixelMap& map, std::optional<float> epsilon, int y);

  std::vector<std::uint64_t> memory_;
};

}  // namespace penumbra::visibility_filter
