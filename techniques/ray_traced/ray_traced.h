// Shadow rays: what one would use instead of every other technique here.
#pragma once

namespace penumbra {

class Registry;
void register_ray_traced(Registry& registry);

}  // namespace penumbra
