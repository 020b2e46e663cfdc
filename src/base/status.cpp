#include "pliant/status.hpp"

namespace pliant {

const char* text(Status status) {
  switch (status) {
    case Status::ok: return "ok";
    case Status::out_of_memory: return "the memory block is too small";
    case Status::bad_argument: return "an argument is null, not finite or out of range";
    case Status::capacity: return "a fixed capacity is used up";
    case Status::truncated: return "the data end before their stated size";
    case Status::bad_magic: return "not a pliant model table";
    case Status::bad_version: return "a model table of another version";
    case Status::bad_checksum: return "the checksum does not match: the table is damaged";
    case Status::bad_table: return "a value in the table is out of range";
    case Status::misaligned: return "the table (4 bytes) or the memory block (16 bytes) is not aligned";
    case Status::too_few_points: return "too few points";
    case Status::underdetermined: return "the points do not determine the pose";
    case Status::size_mismatch: return "a frame of another size";
    case Status::not_started: return "not started: there is no track";
    case Status::not_found: return "not found: no such name, table, face or camera";
    case Status::end_of_stream: return "end of the stream";
    case Status::io_error: return "reading failed or the data are malformed";
    case Status::no_room: return "the mesh is full";
    case Status::bad_index: return "a face refers to a vertex that does not exist";
    case Status::degenerate_face: return "a face has a repeated corner or no area";
    case Status::duplicate_face: return "a face appears twice";
    case Status::non_manifold_edge: return "more than two faces share an edge";
    case Status::non_manifold_vertex: return "the faces around a vertex form more than one fan";
    case Status::non_orientable: return "the surface cannot be oriented";
    case Status::not_basic_blocks: return "the mesh is not a union of basic blocks";
    case Status::not_ready: return "the operator does not apply here";
    case Status::isolated_vertex: return "a vertex belongs to no face";
    case Status::degenerate_data: return "most rows lie in a subspace";
    case Status::camera_lost: return "the camera was unplugged or gives no frames";
    case Status::stale_frame: return "the frame came twice, or late";
  }
  return "unknown status";
}

Version version() {
  return {PLIANT_VERSION_MAJOR, PLIANT_VERSION_MINOR, PLIANT_VERSION_PATCH};
}

}  // namespace pliant
