#include "figure/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lunid::figure {
namespace {

constexpr Colour black{0, 0, 0}, orange{230, 159, 0}, sky{86, 180, 233}, green{0, 158, 115}, yellow{240, 228, 66},
    blue{0, 114, 178}, vermilion{213, 94, 0}, purple{204, 121, 167};

constexpr std::array<Colour, 7> diverging_anchors{
    {{2, 43, 77}, {0, 114, 178}, {128, 185, 217}, {246, 246, 246}, {241, 175, 128}, {213, 94, 0}, {98, 39, 0}}};

constexpr std::array<Colour, 9> sequential_anchors{{{68, 1, 84},
                                                    {71, 45, 123},
                                                    {59, 82, 139},
                                                    {44, 114, 142},
                                                    {33, 145, 140},
                                                    {40, 174, 128},
                                                    {94, 201, 98},
                                                    {173, 220, 48},
                                                    {253, 231, 37}}};

unsigned char mix(unsigned char a, unsigned char b, double share) {
  return static_cast<unsigned char>(std::lround(a + share * (double(b) - double(a))));
}

template <std::size_t N>
Colour between(const std::array<Colour, N>& anchors, double position) {
  const double place = std::clamp(position, 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(place), N - 2);
  const Colour& a = anchors[i];
  const Colour& b = anchors[i + 1];
  const double share = place - static_cast<double>(i);
  return {mix(a.red, b.red, share), mix(a.green, b.green, share), mix(a.blue, b.blue, share)};
}

}  // namespace

Palette palette(Theme theme) {
  if (theme == Theme::dark) return {{22, 24, 29}, {232, 234, 237}, {58, 62, 70}, {62, 66, 74}, {96, 102, 112}};
  return {{255, 255, 255}, {30, 30, 30}, {226, 226, 226}, {232, 232, 232}, {188, 188, 188}};
}

Colour role_colour(Role role, Theme theme) {
  const bool dark = theme == Theme::dark;
  switch (role) {
    case Role::measured: return dark ? Colour{225, 225, 225} : black;
    case Role::baseline: return vermilion;
    case Role::final: return dark ? sky : blue;
    case Role::residual: return purple;
    case Role::effect: return green;
    case Role::noise: return {140, 140, 140};
    case Role::first: return dark ? sky : blue;
    case Role::second: return vermilion;
    case Role::third: return green;
    case Role::fourth: return purple;
    case Role::fifth: return orange;
    case Role::sixth: return dark ? yellow : sky;
  }
  return black;
}

Colour map_colour(double position, bool diverging) {
  return diverging ? between(diverging_anchors, position) : between(sequential_anchors, position);
}

}  // namespace lunid::figure
