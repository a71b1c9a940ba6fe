#include "techniques/bases/find_blocked.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/bases/find_blocked.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/blocked-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra {
namespace HWY_NAMESPACE {

void FindHidden(const BlockedJob& job, int begin, int end, std::uint32_t* words) {
  Search search(job);
  for (int i = begin; i < end; ++i) {
    search.look(i);
    search.hide_below();
    for (int line = 0; line < lines_of(job.cones->n); ++line)
      for (int w = line * words_per_line; w < (line + 1) * words_per_line; ++w)
        *words++ = search.blocked.touched >> line & 1u ? search.blocked.words[w] : 0u;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra {

HWY_EXPORT(FindHidden);

void find_hidden(const BlockedJob& job, int begin, int end, std::uint32_t* words) {
  HWY_DYNAMIC_DISPATCH(FindHidden)(job, begin, end, words);
}

}  // namespace penumbra
#endif  // HWY_ONCE
