#pragma once
// Sample points of triangles, in barycentric coordinates.

namespace pliant {

/// Four inner points: their plain mean is exact for the error of linear interpolation on any quadratic surface. The last is
/// the middle of the subdivision edge, where the next split inserts a vertex; it counts in maxima only.
constexpr int kInnerSamples = 4, kSamples = 5;
constexpr float kTriangleSamples[kSamples][3] = {{1.0f / 3, 1.0f / 3, 1.0f / 3},
                                                 {0.718233513f, 0.140883244f, 0.140883244f},
                                                 {0.140883244f, 0.718233513f, 0.140883244f},
                                                 {0.140883244f, 0.140883244f, 0.718233513f},
                                                 {0.5f, 0.5f, 0}};

}  // namespace pliant
