#pragma once
/// \file occluders.hpp
/// Puts things onto and before faces of training samples: glasses, masks, hands, hair, bars.
#include "host/learn/face_sample.hpp"
#include "host/learn/other_pictures.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

/// Probability that a sample has each of them. Chosen by eye on sheets of samples, not tuned.
struct OccluderTuning {
  float glasses_chance = 0.22f;    ///< glasses, of which a third are dark
  float mask_chance = 0.03f;       ///< cloth over mouth and nose
  float hand_chance = 0.07f;       ///< fingers at the face
  float hair_chance = 0.06f;       ///< strands over forehead and cheeks
  float bar_chance = 0.07f;        ///< something before the face: a bar, a plate, a part of another picture
  float moustache_chance = 0.06f;  ///< moustaches and beards
};

/// Draws occluders into the picture at random. Landmarks under them lose their trust; their positions stay.
/// \param landmarks_mm  of the model at the sample's parameters, model axes.
/// \param others        may be empty.
void add_occluders(FaceSample& sample, const Model& model, const std::vector<Vec3>& landmarks_mm,
                   const OtherPictures& others, const OccluderTuning& tuning, SampleRandom& random);

}  // namespace pliant::host::learn
