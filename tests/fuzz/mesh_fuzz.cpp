// Takes any bytes as the triangles of a base mesh and then as operations on it. No input may crash; the
// status of each operation must match what the mesh is afterwards; a mesh that was accepted must stay valid.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "pliant/base_mesh.hpp"
#include "pliant/mesh.hpp"

using namespace pliant;

namespace {

struct Bytes {
  const std::uint8_t* at;
  const std::uint8_t* end;
  unsigned next() { return at < end ? *at++ : 0; }
};

void require(bool condition) {
  if (!condition) std::abort();
}

alignas(16) unsigned char mesh_block[1 << 16], maker_block[1 << 16];

void operate(Mesh& mesh, Bytes& bytes) {
  const int euler = mesh.compute_statistics().euler;
  while (bytes.at < bytes.end) {
    const unsigned op = bytes.next(), what = bytes.next();
    const auto face = static_cast<FaceId>(what), vertex = static_cast<VertexId>(what);
    VertexId inserted = kNone;
    switch (op % 7) {
      case 0:
        (void)mesh.refine(face);
        break;
      case 1:
        (void)mesh.simplify(vertex);
        break;
      case 2:
        (void)mesh.split_edge(static_cast<HalfEdgeId>(3 * what + op % 3), inserted);
        break;
      case 3:
        (void)mesh.weld_edge(vertex);
        break;
      case 4:
        (void)mesh.split_face(face, inserted);
        break;
      case 5:
        (void)mesh.weld_face(vertex);
        break;
      default:
        mesh.clear_changes();
        break;
    }
    const int fault = mesh.validate().invariant;
    require(fault == 0 || fault == 9 || fault == 13);  // areas and midpoints may vanish in rounding
  }
  require(mesh.compute_statistics().euler == euler);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes{data, data + size};
  const std::size_t vertices = bytes.next() % 24, faces = bytes.next() % 40;
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;
  for (std::size_t v = 0; v < vertices; ++v) {
    const float x = static_cast<float>(bytes.next()) / 256;
    uv.push_back({x, static_cast<float>(bytes.next()) / 256});
  }
  for (std::size_t i = 0; i < 3 * faces; ++i)
    corners.push_back(static_cast<std::uint16_t>(bytes.next() % (vertices + (i % 7 == 0 ? 1 : 0) + 1)));
  const Span<const Vec2> uv_span{uv.data(), uv.size()};
  const Span<const std::uint16_t> corner_span{corners.data(), corners.size()};

  Arena maker_arena(maker_block, sizeof maker_block);
  BaseMeshMaker maker;
  require(create_in(maker_arena, maker, BaseMeshLimits{24, 40, true}) == Status::ok);
  const Status by_splits = maker.by_splits(uv_span, corner_span, Winding::counter_clockwise);
  const Status by_pairing = maker.by_pairing(uv_span, corner_span, Winding::clockwise);
  // Midpoints and barycentres of slivers may coincide; all else is the same for both ways.
  require(by_splits == by_pairing);

  Arena arena(mesh_block, sizeof mesh_block);
  Mesh mesh;
  require(create_in(arena, mesh, MeshLimits{200, 300, 10}) == Status::ok);
  if (mesh.set_triangles(uv_span, corner_span) == Status::ok) {
    Bytes copy = bytes;
    operate(mesh, copy);
  }
  if (by_pairing == Status::ok && mesh.set_base(maker.uv(), maker.corners()) == Status::ok) {
    const std::uint32_t base = mesh.compute_digest();
    operate(mesh, bytes);
    mesh.simplify_all();
    require(mesh.compute_digest() == base);
  } else {
    require(by_pairing != Status::ok);
  }
  return 0;
}
