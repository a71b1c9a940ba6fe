// Images of rows side by side with what they are: technique, time, error; the truth once; the colours' scale.
#pragma once

#include <string>
#include <vector>

#include "harness/results/lettering.h"
#include "harness/results/row.h"

namespace penumbra {

/// Draws a sheet. `parts`: rows by scene, in the order in which they are shown; each part begins with its truth and has
/// the signed errors below the images, in at most so many columns. `folder`: of results, whose images are read. A row
/// whose image cannot be read is left out, and one of vertices makes no picture. An empty image if nothing is left.
/// Without a font there are no labels, and one warning says so.
Image draw_sheet(const std::string& folder, const std::vector<std::vector<const Row*>>& parts, int columns,
                 const Lettering& lettering = Lettering());

/// Writes overview.png beside the images of one scene with one set of spheres: all rows of it, in the order of the run.
/// `images`: that folder below the folder of results. What cannot be written is a warning.
void save_overview(const std::string& folder, const std::string& images, const std::vector<Row>& rows);

}  // namespace penumbra
