#pragma once
/// \file detection_films.hpp
/// Films made of annotated portraits, on which a tracker starts, loses the face and finds it again by itself.
#include <vector>

#include "host/bench/annotated_faces.hpp"
#include "host/bench/detection_report.hpp"
#include "host/io/files.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host {

/// Each portrait shown for two seconds with drift and noise: errors at the start and at the end.
void measure_films(const ModelFile& file, const std::vector<AnnotatedFace>& faces, DetectionReport& report);

/// Each portrait in front of one of `others` (a drawn background if there is none) for a second, then gone for a second, then
/// elsewhere for a second, at half and at twice its size: frames until it is lost, and until it is found again.
void measure_returns(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                     const learn::OtherPictures& others, DetectionReport& report);

/// Each portrait in front of one of `others`, all turned about the middle of the frame by an angle that is different for each, for
/// two seconds: errors at the start, and after which frame it is.
void measure_rolled(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                    const learn::OtherPictures& others, DetectionReport& report);

/// A right track is started again beside the face, with the same pose: frames until it is lost or right.
void measure_pushed(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                    const learn::OtherPictures& others, DetectionReport& report);

/// Each photograph without faces shown for two seconds with drift and noise: false starts.
void measure_without_faces(const ModelFile& file, const learn::OtherPictures& others, std::size_t count,
                           DetectionReport& report);

}  // namespace pliant::host
