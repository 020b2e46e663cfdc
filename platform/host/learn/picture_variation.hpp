#pragma once
/// \file picture_variation.hpp
/// What light, lens, sensor and storage do to a picture: varied at random for training.
#include "host/io/image.hpp"
#include "host/learn/sample_random.hpp"
#include "pliant/face_box.hpp"

namespace pliant::host::learn {

/// How strongly and how often pictures are varied: a chance is the probability in a sample. Chosen by eye on sheets of samples, so
/// that the worst are still recognised by a person.
struct PictureVariationTuning {
  float gamma_octaves = 0.9f;      ///< largest change of the exponent, either way, in powers of 2
  float side_light_chance = 0.5f;  ///< chance of light that falls off across the face
  float darkest_side = 0.15f;  ///< light on the dark side, at least, as a fraction of that on the bright side
  float hard_shadow_chance = 0.12f;          ///< chance of a shadow with a sharp edge
  float gain_low = 0.35f, gain_high = 1.5f;  ///< factor on all grey levels, least and largest
  float low_contrast_chance = 0.1f;          ///< chance of grey levels nearer to their mean
  float blur_chance = 0.45f;                 ///< chance of a picture out of focus
  float blur_px = 1.6f;         ///< largest standard deviation of that blur, px for a face of 100 px
  float motion_chance = 0.12f;  ///< chance of a blur along a line
  float motion_px = 7;          ///< longest way of that blur, px for a face of 100 px
  float noise_chance = 0.6f;    ///< chance of white noise
  float noise_grey = 14;        ///< largest standard deviation of the noise, grey levels
  float noise_contrast = 0.4f;  ///< the same as a fraction of the face's standard deviation
  float blocks_chance = 0.4f;   ///< chance of compression as JPEG does it
};

/// Varies a grey picture in place.
/// \param face  where the light falls off, and how large a blur may be.
void vary_picture(Image& picture, const FaceBox& face, const PictureVariationTuning& tuning,
                  SampleRandom& random);

}  // namespace pliant::host::learn
