// The members of the pipeline of soft_shadow.h: what the parameters of each mean to it.
#pragma once

#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss {

SoftOptions pcss_options(const Parameters& p);
SoftOptions hqepcss_options(const Parameters& p);
SoftOptions fast_pcss_options(const Parameters& p);

/// A member is the pipeline on a backend (`Shadow`) with options of its own.
template <class Shadow, SoftOptions (*options)(const Parameters&)>
class Member final : public Shadow {
 public:
  explicit Member(const Parameters& p) : Shadow(p, options(p)) {}
};

/// The values that a member with a multi-scale map allows; the default of each parameter comes first.
struct MultiScaleChoices {
  std::vector<ParameterValue> levels, snap_size, snap_place, search;
};
/// Returns what the entries of such members say alike, with the member's `own` parameters.
Entry multi_scale_entry(const MultiScaleChoices& choices, const std::vector<Parameter>& own = {});

/// Reads how a region is summed, as the parameters `search` and `filter` name it.
inline Sum read_sum(const std::string& name) {
  return name == "texels" ? Sum::texels : name == "nearest" ? Sum::nearest : Sum::sampled;
}

}  // namespace penumbra::pcss
