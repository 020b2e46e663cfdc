#pragma once
// Names of the iBUG scheme's landmarks: ibug00 to ibug67.

namespace pliant {

/// Whether a landmark's name begins with `ibug`.
inline bool is_ibug_landmark(const char* name) {
  return name[0] == 'i' && name[1] == 'b' && name[2] == 'u' && name[3] == 'g';
}

}  // namespace pliant
