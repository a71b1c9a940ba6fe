// How wide the filter of a pixel is (Yang et al. 2019, section 2.3). Its equations are lost in the text that we have,
// so the formulas are reconstructed from its words.
//
// The lamp, a disc of diameter D1 at distance d_L, is seen from the receiver under alpha = 2 atan(D1 / 2 d_L); the
// nearest caster, a disc of diameter D2 = D1 / e2 at distance d_V, under beta = 2 atan(D2 / 2 d_V). With N the widest
// filter,
//   f1 = N clamp((alpha - beta) / alpha, 0, 1)          angles: 0 at contact, and never falls as the caster recedes
//   f1 = N |alpha - beta| / max(alpha, beta)            literal: as the words say; rises again towards contact
//   f2 = f1 D / d                                       d the pixel's distance to the eye, D the one that f1 is meant
//   for
// and the width is 2 floor(f2 / 2) + 1, at least 1 and at most N.
#pragma once

#include <cmath>

#include "scenes/math.h"

namespace penumbra::visibility_filter {

struct WidthModel {
  int most = 20;                ///< N, pixels
  float light_diameter = 1.0f;  ///< D1, m
  float caster_share = 12.0f;   ///< e2 = D1 / D2
  bool literal = false;
  float view_depth = 0.0f;  ///< D, m; 0: wherever the eye is
};

/// Pixels on either side of one whose nearest caster is `to_caster` away, m; 0 where there is no caster, where it
/// touches, or where nothing is seen.
PENUMBRA_HD inline int filter_radius(const WidthModel& model, float to_light, float to_caster, float to_eye) {
  if (!(to_light > 0.0f && to_caster > 0.0f && model.light_diameter > 0.0f)) return 0;
  const float alpha = std::atan(0.5f * model.light_diameter / to_light);
  const float beta = std::atan(0.5f * model.light_diameter / (model.caster_share * to_caster));
  const float more = alpha - beta, larger = alpha > beta ? alpha : beta;
  const float share = model.literal ? std::fabs(more) / larger : more / alpha;
  const float width = float(model.most) * share * (model.view_depth > 0.0f ? model.view_depth / to_eye : 1.0f);
  if (!(width >= 2.0f)) return 0;
  const int most = (model.most - 1) / 2;
  return width < float(model.most) ? (int(width) / 2 < most ? int(width) / 2 : most) : most;
}

}  // namespace penumbra::visibility_filter
