#pragma once
/// \file level_tints.hpp
/// Colours of a mesh's faces by level.
#include "host/io/image.hpp"

namespace pliant::host {

/// From nearly white over yellow and orange to dark red; all deeper levels have the last colour.
inline Colour level_tint(int level) {
  constexpr Colour kTints[] = {{248, 248, 244}, {255, 240, 190}, {254, 217, 118}, {254, 178, 76},
                               {253, 141, 60},  {240, 80, 50},   {200, 30, 40},   {140, 10, 40}};
  constexpr int kCount = static_cast<int>(sizeof kTints / sizeof kTints[0]);
  return kTints[level < 0 ? 0 : level >= kCount ? kCount - 1 : level];
}

}  // namespace pliant::host
