#pragma once
/// \file annotated_faces.hpp
/// Landmarks that people annotated, and how far a tracker's landmarks are from them.
#include <map>
#include <string>
#include <vector>

#include "host/io/image.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

/// Landmarks by name, px.
using NamedLandmarks = std::map<std::string, Vec2>;

/// A grey picture of one face.
struct AnnotatedFace {
  std::string name;
  Image picture;
  NamedLandmarks landmarks;
};

/// Reads the faces of a folder, as learn::read_annotated does, that training never uses.
std::vector<AnnotatedFace> read_held_out_faces(const std::string& folder);

/// Reads `frame,landmark,x,y`: the landmarks of each frame, from frame 0. Bad input as for CsvTable.
std::vector<NamedLandmarks> read_annotated_frames(const std::string& path);

/// Distance between the outer corners of the eyes, px; 0 if one of them is not annotated.
float eye_distance(const NamedLandmarks& truth);

/// Mean distance of the inner landmarks (ibug17 to ibug67) that both have, as a fraction of the distance of the outer
/// corners of the eyes. NaN if there is none.
double landmark_error(const NamedLandmarks& found, const NamedLandmarks& truth);

/// The landmarks where the picture is turned about a point, clockwise.
NamedLandmarks turned(const NamedLandmarks& landmarks, float radians, Vec2 about);

/// The landmarks at a frame that shows the picture scaled about the origin and then moved.
NamedLandmarks moved(const NamedLandmarks& landmarks, float scale, Vec2 shift);

}  // namespace pliant::host
