#pragma once
/// \file photo_mesh.hpp
/// A photograph as a surface in space: the fitted model inside the face, a smooth relief around it. Rendered again it shows
/// the person from another side, with another expression.
#include <vector>

#include "host/learn/face_sheet.hpp"
#include "host/learn/mipmap.hpp"
#include "host/learn/photographs.hpp"
#include "host/learn/texture_raster.hpp"

namespace pliant::host::learn {

/// Shape of the relief around a face. Lengths in millimetres, in the plane of the photograph unless said otherwise.
/// Chosen by eye on sheets of turned photographs.
struct PhotoReliefTuning {
  float step = 5;          ///< between the vertices around the face
  float head_radius = 75;  ///< from the edge of the face to where the head ends
  float head_depth = 95;   ///< from the edge of the face back to there
  float turns_fully = 45;  ///< up to this distance from the face the surroundings turn with it
  float stays = 140;       ///< from this distance on they stay
  float follows = 25;      ///< distance in which they stop following a change of the face's shape
  float behind = 4;        ///< depth of the surroundings behind the face where it covers them
  float apart = 1;  ///< distance of landmarks in which the photograph is drawn to the model's (see PhotoMesh)
  Vec3 pivot{0, -55, -85};  ///< of the head on the neck, in the model
};
inline constexpr PhotoReliefTuning kPhotoReliefTuning{};

/// How a photograph is rendered again.
struct PhotoTurn {
  Camera camera;
  Pose pose;             ///< of the face
  std::vector<float> q;  ///< of the face
  /// Of what is far from the head; it is joined to the head at the pivot.
  Quat body;
  Vec3 light;             ///< direction to a light in camera axes, times its strength; 0: as photographed
  float cover_mm = 1e9f;  ///< what is farther from the face fades into the background
};

/// One photograph's surface. The photograph is bent a little so that its landmarks are those of the fitted model: the truth
/// of a new view is what the model projects.
class PhotoMesh {
 public:
  /// \param sheet  of the same model; outlives this object.
  PhotoMesh(const Photograph& photograph, const FaceSheet& sheet, Cascade& cascade);

  /// Draws the new view. Cost: a few milliseconds.
  void draw(const PhotoTurn& turn, Cascade& cascade, TextureRaster& raster) const;
  /// The picture of what was drawn.
  /// \param photograph  the pixels. \param scale  of the face in the picture over that in the photograph.
  /// \param background  where nothing was drawn; gives the size.
  Image picture(const TextureRaster& raster, const Mipmap& photograph, float scale,
                const Image& background) const;

 private:
  struct Node {  // around the face
    Vec2 texture;
    Vec3 p;                 // model axes, mm
    float distance;         // to the face, mm
    std::uint32_t nearest;  // vertex of the face
  };
  float grey(const TextureFragment& fragment, const Mipmap& photograph, const Mipmap::Detail& detail) const;
  void bend(const Photograph& photograph, Cascade& cascade);
  void make_relief(const Photograph& photograph);
  void mark_openings(const Photograph& photograph);
  std::vector<TextureVertex> face_vertices(const PhotoTurn& turn, const std::vector<Vec3>& positions) const;
  std::vector<TextureVertex> surroundings(const PhotoTurn& turn, const std::vector<Vec3>& positions,
                                          const std::vector<TextureVertex>& face) const;

  const FaceSheet& sheet_;
  View fit_;                  // of the photograph
  std::vector<Vec3> fitted_;  // a vertex of the sheet
  std::vector<Vec2> bend_;    // texture minus projection, px, a vertex of the sheet
  std::vector<Node> nodes_;
  std::vector<FaceTriangle> around_;
  Image openings_;   // 255 where the photograph shows an eye or the inside of the mouth
  float dark_ = 20;  // inside of the mouth
};

}  // namespace pliant::host::learn
