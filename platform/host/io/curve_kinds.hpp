#pragma once
/// \file curve_kinds.hpp
/// Names of the kinds of curves, in text tables and in print.

namespace pliant::host {

/// In the order of CurveKind.
constexpr const char* kCurveKindNames[] = {"lid", "lip", "brow", "boundary"};

}  // namespace pliant::host
