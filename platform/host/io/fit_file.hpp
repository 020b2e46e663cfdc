#pragma once
/// \file fit_file.hpp
/// Reads and writes `fit.json`: a model fitted to a picture. `pliant fit` writes it; `pliant track` starts from it.
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "pliant/camera.hpp"
#include "pliant/model.hpp"

namespace pliant::host {

using NamedValues = std::vector<std::pair<std::string, float>>;

struct FitPoint {
  std::string landmark;
  Vec2 x;         ///< given position, px
  Vec2 residual;  ///< projected minus given, px
  bool used = false;
  bool is_landmark =
      false;  ///< the model's landmark itself: no (u,v) was given, and it did not slide along the silhouette
};

struct FitFile {
  std::uint32_t model_crc = 0;
  int width = 0, height = 0;
  Camera camera;
  Pose pose;
  NamedValues parameters, sd;
  std::vector<std::string> unseen;  ///< parameters that the points do not determine
  float rms_px = 0;
  std::size_t inliers = 0;
  float landmark_error = 0;  ///< of alignment in the picture: as AlignedFace::landmark_error; 0: unknown
  std::vector<FitPoint> points;
};

/// Bad input, naming the member, for anything but a complete file of version 1 with finite numbers and a
/// valid pose.
FitFile parse_fit(const std::string& source, const std::string& text);
std::string fit_text(const FitFile& fit);

/// Normalises a quaternion from a file unless it has unit length already; normalising again could change its last bit.
Quat unit_of(Quat q);
/// Whether a row of a table may mean a rotation: half to twice the unit length, as where one component alone is given.
bool is_nearly_unit(Quat q);

/// The parameters that a name drives: the parameter of that name, or both sides if the name stands for a pair (`browInnerUp`).
/// Empty if there is none; so for `jaw` and `mouth`, whose Left and Right are directions.
std::vector<std::uint16_t> parameters_named(const Model& model, const std::string& name);

/// Parameters that the names of a source give, each once.
class GivenParameters {
 public:
  explicit GivenParameters(const std::string& source) : source_(source) {}
  /// Notes what a name drives. Bad input in the source if another name drives one of these, as `browInnerUp` and
  /// `browInnerUpLeft` do.
  void add(const std::string& name, const std::vector<std::uint16_t>& parameters);

 private:
  std::string source_;
  std::map<std::uint16_t, std::string> names_;
};

/// Sets the named values in q (all parameters). Bad input in `source` for a value outside its parameter's limits, and for a
/// parameter that two names give.
/// \return the names that the model does not have.
std::vector<std::string> apply(const NamedValues& values, const std::string& source, const Model& model,
                               float* q);

/// All parameters of a fit: the values that it names, 0 for the others. Names that the model does not have are passed over.
/// Bad input as in apply.
std::vector<float> all_parameters(const FitFile& fit, const std::string& source, const Model& model);

/// Writes one line with the names of parameters that a model does not have; nothing if there are none.
/// \param source  the file that has them.
void list_unmatched(const std::vector<std::string>& names, const std::string& source, std::ostream& err);
/// The same of parameters whose values are outside the model's limits, which clamp them. \param hint  ends the line.
void list_clamped(const std::vector<std::string>& names, const std::string& source, std::ostream& err,
                  const std::string& hint = "");

}  // namespace pliant::host
