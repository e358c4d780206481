#pragma once
// Colours that a colour-blind reader can tell apart.
#include "figure/canvas.hpp"
#include "figure/figure.hpp"

namespace lunid::figure {

/// The colours of paper and ink.
struct Palette {
  Colour background;
  Colour ink;      ///< text and frames
  Colour faint;    ///< grid lines
  Colour no_data;  ///< cells without data
  Colour hatch;
};

Palette palette(Theme theme);

/// Okabe and Ito, "Color universal design" (2008): black, vermilion, blue and their kin.
Colour role_colour(Role role, Theme theme);

/// The colour at `position` in [0, 1], clamped. Diverging: the palette's blue through near-white to its
/// vermilion, light in the middle; sequential: viridis (Smith and van der Walt, 2015).
Colour map_colour(double position, bool diverging);

}  // namespace lunid::figure
