#pragma once
// Builds small model tables in memory for the tests of the core, which must run where the host's baker does not.
#include <functional>
#include <string>
#include <vector>

#include "aligned_block.hpp"
#include "pliant/model.hpp"

struct ModelBuilder {
  using Function = std::function<pliant::Vec3(float u, float v)>;

  std::vector<pliant::Parameter> parameters;
  std::vector<pliant::Field> fields;
  std::vector<unsigned char> samples;
  std::vector<pliant::CascadeRecord> cascade;
  std::vector<pliant::Vec2> vertices;
  std::vector<std::uint16_t> corners;
  std::vector<pliant::Landmark> landmarks;
  std::vector<pliant::Curve> curves;
  std::vector<pliant::Vec2> curve_points;
  std::vector<unsigned char> stretch, detector, aligner;  // sections, if not empty

  ModelBuilder();  // these three are in the source, so that they are compiled once
  ModelBuilder(const ModelBuilder&);
  ~ModelBuilder();

  std::uint16_t parameter(const std::string& name, pliant::Group group, float lo, float hi, float sd);

  /// Samples `f` on a grid over the rectangle, to half a quantisation step.
  std::uint16_t field(int components, int width, int height, const Function& f, float u0 = 0, float v0 = 0,
                      float u1 = 1, float v1 = 1, bool mirror = false, int bits = 16);

  pliant::CascadeRecord& record(pliant::Operation operation, std::vector<std::uint16_t> sources,
                                std::vector<std::uint16_t> q, std::uint16_t field_index = pliant::kNone,
                                std::uint16_t weight = pliant::kNone);
  std::uint16_t last() const { return static_cast<std::uint16_t>(cascade.size() - 1); }

  void landmark(const std::string& name, float u, float v);

  void curve(const std::string& name, pliant::CurveKind kind, const std::vector<pliant::Vec2>& points);

  /// A base mesh of n x n squares over the chart, each a basic block.
  void grid_mesh(int n);

  /// The table, as bytes held in 4-byte words.
  std::vector<std::uint32_t> table() const;
};

/// Memory for one object laid out in an arena of just its size.
template <class T>
struct InArena {
  AlignedBlock block;
  pliant::Arena arena;
  T object;
  template <class... Args>
  explicit InArena(const Args&... args)
      : block(pliant::measured_bytes<T>(args...)), arena(block.data(), block.size()) {
    object.lay_out(arena, args...);
  }
  T* operator->() { return &object; }
};

/// An egg-shaped surface about the size of a face with `identities` smooth identity fields (sd 1) and four expression
/// fields: a bump with support in the left half, its mirror image, a hinge at the bottom and a stretch.
ModelBuilder egg_model(int identities = 6);
