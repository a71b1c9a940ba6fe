#include "harness/measure/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "harness/measure/black_truth.h"
#include "harness/results/pictures.h"
#include "harness/results/statistics.h"

namespace penumbra {

Sequence::Sequence(const Scene& scene, const ReferenceSettings& settings, const ReferenceProgress& progress)
    : scene_(scene) {
  Animation animation(scene);
  const bool carried = animation.deforms() && !scene.mesh.empty() && !scene.spheres.empty();
  const SphereCarrier carrier =
      carried ? SphereCarrier(scene.mesh, scene.spheres, scene.motion.carry) : SphereCarrier();
  SphereSet moved = scene.spheres;
  for (int f = 0; f < animation.frames(); ++f) {
    const Frame frame = animation.frame(f);
    const auto share_of_frame = [&](double share) { progress((f + share) / animation.frames()); };
    share_of_frame(0.0);
    const Reference truth = cached_reference(frame, Rung::truth, settings, share_of_frame);
    valid_.push_back(valid_receivers(frame.receivers));
    black_.push_back(black_level(frame.light, frame.receivers));
    rel_noise_.push_back(relative(truth.noise(valid_.back()), rms(truth.mean, valid_.back()), black_.back()));
    truth_.push_back(truth.mean);
    if (!scene.mesh.empty() && !scene.spheres.empty()) coverage_.push_back(surface_coverage(frame.mesh, frame.spheres));
    if (!carried) continue;
    const auto start = std::chrono::steady_clock::now();
    carrier.move(frame.mesh, moved);
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    carry_ms_ += spent.count() / animation.frames();
  }
}

SequenceErrors Sequence::score(Technique& technique, double exposure, const std::string& sheet_file) const {
  SequenceErrors errors;
  errors.coverage = coverage_, errors.rel_noise = mean_defined(rel_noise_), errors.carry_ms = carry_ms_;
  Animation animation(scene_);
  std::vector<std::vector<Image>> sheet(3);
  Image before;
  for (std::size_t f = 0; f < truth_.size(); ++f) {
    const Frame frame = animation.frame(int(f));
    const Image& truth = truth_[f];
    Image image{truth.width, truth.height, std::vector<vec3>(truth.pixels.size(), vec3(NAN))};
    technique.update(frame);
    technique.shade({image.pixels.data(), image.width, image.height});
    Image error = difference(image, truth);
    const double scale = rms(truth, valid_[f]);
    errors.rel_rmse.push_back(relative(rms(error, valid_[f]), scale, black_[f]));
    if (f > 0) errors.flicker.push_back(relative(rms(difference(error, before), valid_[f]), scale, black_[f]));
    sheet[0].push_back(thumbnail(exposed(truth, exposure)));
    sheet[1].push_back(thumbnail(exposed(image, exposure)));
    sheet[2].push_back(thumbnail(signed_error(image, truth, exposure)));
    before = std::move(error);
  }
  if (!truth_.empty()) try_to_save([&] { save_png(sheet_file, contact_sheet(sheet)); });
  return errors;
}

}  // namespace penumbra
