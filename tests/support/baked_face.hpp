#pragma once
// The built-in face as `pliant bake` makes it by default. The host build bakes it once for all test programs, and those
// of a target read the host build's file.
#include "baked_model.hpp"

const char* baked_face_path();

BakedModel& baked_face();
