// Ctrl-C: the first asks the run to stop after what it is doing, the second ends the program.
#pragma once

namespace penumbra {

void watch_interrupts();
bool interrupted();

}  // namespace penumbra
