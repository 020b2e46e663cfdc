#pragma once
/// \file pliant.hpp
/// Everything that an application needs to track a face: include this header, link `pliant::track`.
///
/// The order of the calls, from C++ as from C (pliant.h):
///   1. `Model::open` checks the model table, once. The table stays where it is, in flash or in a file's buffer.
///   2. `measured_bytes<Tracker>(model, limits)` gives the bytes of memory; `create_in` takes them from an Arena.
///   3. `Tracker::update` for every frame: it finds the face and tracks it. A `start_from_...` on the first
///      frame is optional.
///   4. `landmark` and `parameter` read results by name while `is_started()`.
///
/// The other headers of this folder are the parts that the tracker is made of, for applications that fit single images
/// (fit.hpp), bring their own image processing (estimator.hpp) or use the adaptive mesh alone (mesh.hpp, adapt.hpp).
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/status.hpp"
#include "pliant/tracker.hpp"
#include "pliant/version.h"
