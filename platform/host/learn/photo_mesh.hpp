#pragma once
/// \file photo_mesh.hpp
/// A photograph as a surface in space: the fitted model inside the face, a smooth relief around it. Rendered again it shows
/// the person from another side, with another expression.
#include <array>
#include <vector>

#include "host/learn/face_sheet.hpp"
#include "host/learn/mipmap.hpp"
#include "host/learn/photo_relief.hpp"
#include "host/learn/photo_turn.hpp"
#include "host/learn/photographs.hpp"
#include "host/learn/texture_raster.hpp"

namespace pliant::host::learn {

/// One photograph's surface. The photograph is bent a little so that its landmarks are those of the fitted model: the truth
/// of a new view is what the model projects.
class PhotoMesh {
 public:
  /// \param sheet  of the same model; outlives this object.
  PhotoMesh(const Photograph& photograph, const FaceSheet& sheet, Cascade& cascade);

  /// Draws the new view. Cost: a few milliseconds.
  void draw(const PhotoTurn& turn, Cascade& cascade, TextureRaster& raster) const;
  /// The picture of what was drawn.
  /// \param turn        as drawn. \param pictures  pixels of this photograph and of the second one, if there is one.
  /// \param background  where nothing was drawn; gives the size.
  Image picture(const PhotoTurn& turn, const TextureRaster& raster,
                const std::array<const Mipmap*, 2>& pictures, const Image& background) const;
  /// Where the pupils of the new view are, and whether they show. \param raster  as drawn.
  Pupils pupils(const PhotoTurn& turn, Cascade& cascade, const TextureRaster& raster) const;

 private:
  Vec2 iris_source(Vec2 x, Vec2 gaze) const;
  float eye_or_mouth(const TextureFragment& fragment, const Mipmap& photograph,
                     const Mipmap::Detail& detail, Vec2 gaze) const;
  void bend(const Photograph& photograph, Cascade& cascade);
  void mark_openings(const Photograph& photograph);
  std::vector<TextureVertex> face_vertices(const PhotoTurn& turn, const std::vector<Vec3>& positions) const;

  const FaceSheet& sheet_;
  View fit_;                   // of the photograph
  std::vector<Vec3> fitted_;   // a vertex of the sheet
  std::vector<Vec2> bend_;     // texture minus projection, px, a vertex of the sheet
  std::vector<Vec2> texture_;  // px of the photograph, a vertex of the sheet
  Pupils pupils_;              // of the photograph
  PhotoRelief relief_;
  Image openings_;    // 255 where the photograph shows an eye or the inside of the mouth
  float mean_ = 128;  // grey of the face
};

}  // namespace pliant::host::learn
