#pragma once
/// \file photo_relief.hpp
/// What surrounds the face of a photograph as a surface in space: hair, neck, clothes and background.
#include <vector>

#include "host/io/image.hpp"
#include "host/learn/face_sheet.hpp"
#include "host/learn/photo_turn.hpp"
#include "host/learn/texture_raster.hpp"

namespace pliant::host::learn {

/// Shape of the relief around a face. Lengths in millimetres, in the plane of the photograph unless said otherwise.
/// Chosen by eye on sheets of turned photographs.
struct PhotoReliefTuning {
  float step = 5;           ///< between the vertices around the face
  float head_radius = 75;   ///< from the edge of the face to where the head ends
  float head_depth = 95;    ///< from the edge of the face back to there
  float turns_fully = 45;   ///< up to this distance from the face the surroundings turn with it
  float stays = 140;        ///< from this distance on they stay
  float follows = 25;       ///< distance in which they stop following a change of the face's shape
  float behind = 4;         ///< depth of the surroundings behind the face where it covers them
  Vec3 pivot{0, -55, -85};  ///< of the head on the neck, in the model
};
inline constexpr PhotoReliefTuning kPhotoReliefTuning{};

/// A regular grid over the photograph. Its depth continues that of the face and falls off like a head. Near the face it turns
/// with it, far from it it stays.
class PhotoRelief {
 public:
  PhotoRelief() = default;
  /// \param fitted  positions of the sheet's vertices in the photograph's view, mm.
  PhotoRelief(const Image& photograph, const View& view, const FaceSheet& sheet,
              const std::vector<Vec3>& fitted);

  const std::vector<FaceTriangle>& triangles() const { return triangles_; }
  /// The vertices in a new view.
  /// \param moved  of the sheet's vertices since the photograph, mm. \param face  the sheet's vertices in the new view.
  std::vector<TextureVertex> vertices(const PhotoTurn& turn, const std::vector<Vec3>& moved,
                                      const std::vector<TextureVertex>& face) const;

 private:
  struct Grid;
  struct Node {
    Vec2 texture;
    Vec3 p;                 // model axes, mm
    float distance;         // to the face, mm
    std::uint32_t nearest;  // vertex of the face
  };
  static Grid grid_over(const Image& picture, float step_px);
  void connect(const Grid& grid);

  std::vector<Node> nodes_;
  std::vector<FaceTriangle> triangles_;
};

}  // namespace pliant::host::learn
