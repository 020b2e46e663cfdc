#pragma once
/// \file learn_parts.hpp
/// Learns the table of part readers: which parts of a face are read, and how.
#include <cstdint>
#include <vector>

#include "host/learn/learn_options.hpp"
#include "host/learn/other_pictures.hpp"
#include "host/learn/photographs.hpp"

namespace pliant::host::learn {

/// Learns all parts.
/// \param photographs, others  as FaceSamples takes them.
std::vector<std::uint8_t> learn_parts(const Model& model, const std::vector<Photograph>& photographs,
                                      const OtherPictures& others, const LearnOptions& options,
                                      const LearnProgress& progress);

}  // namespace pliant::host::learn
