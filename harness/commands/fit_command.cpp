#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "harness/commands/commands.h"
#include "harness/commands/fit_picture.h"
#include "harness/measure/progress.h"
#include "scenes/assets.h"
#include "scenes/error.h"

namespace penumbra {

void fit(const FitOptions& options) {
  if (!options.output.ends_with(".json")) throw Error("-o {}: the name must end in .json", options.output);
  Progress progress;
  progress.step("loading " + options.mesh);
  const Mesh mesh = mesh_by_name(options.mesh);
  progress.step(fmt::format("fitting {} spheres", options.request.spheres));
  const auto start = std::chrono::steady_clock::now();
  const SphereSet set = fit_spheres(mesh, options.request, options.mesh,
                                    [&](const std::string& stage, double share) { progress.share(stage, share); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.step("measuring and drawing the fit");
  save_spheres(options.output, set, mesh.origin);
  const std::string picture = std::filesystem::path(options.output).replace_extension(".png").string();
  save_png(picture, draw_fit(mesh, set, 480));
  const FitQuality quality = assess_fit(mesh, set, options.mesh);
  progress.finish();
  const auto percent = [&](double volume) { return quality.volume > 0.0 ? 100.0 * volume / quality.volume : 0.0; };
  fmt::print(
      "{}: {} spheres for {} in {:.2f} s, seed {}\n"
      "  volume of the solid  {:.6g} m^3\n"
      "  outside, summed      {:.6g} m^3 ({:.2f} %)\n"
      "  outside, of union    {:.6g} m^3 ({:.2f} %)\n"
      "  uncovered            {:.6g} m^3 ({:.3f} %; coverage {:.3f} %)\n"
      "  picture              {}\n",
      options.output, set.size(), to_string(options.request.objective), seconds, options.request.seed, quality.volume,
      quality.outside, percent(quality.outside), quality.excess, percent(quality.excess), quality.uncovered,
      percent(quality.uncovered), 100.0 * quality.coverage(), picture);
}

}  // namespace penumbra
