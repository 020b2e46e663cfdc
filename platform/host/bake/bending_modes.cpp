// Energy: a thin plate. Stretching is that of constant-strain triangles. Bending is that of the curvature which is constant over a
// triangle and gives the changes of angle at its three edges (the basic plate triangle of Onate and Zarate 2000); angles have
// their exact gradient (Bridson, Marino and Fedkiw 2003), which no rigid motion changes. Eigenvectors: subspace iteration with
// the factorised matrix.
#include "host/bake/bending_modes.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "host/bake/at.hpp"
#include "host/bake/symmetric_eigen.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the modes. Each constant: unit, reason, experiment.
struct ModeTuning {
  /// Thickness over the diagonal. Thinner surfaces stretch less while they bend, and need more digits. Round value, not tuned.
  double thickness = 0.003;
  /// Displacement of the first mode over the diagonal, root mean square, at one standard deviation. A sheet of paper in two hands
  /// bends by about as much. Round value, not tuned.
  double first_mode = 0.05;
  /// Corrections that move the surface by less at one standard deviation of both modes are left out, fraction of the diagonal, root
  /// mean square. Film A of tests/bench/sheet_film.py, 12 modes, this many shapes, mean error over the width: 0 (78) 0.32 %,
  /// 0.002 (53) 0.32 %, 0.003 (36) 0.33 %, 0.005 (16) 0.56 %; without any 2.1 %.
  double least_correction = 0.003;
  /// Poisson's ratio of the plate, no unit. A usual value, not tuned.
  double poisson = 0.3;
  /// Fraction of the trace that keeps a patch of triangles regular whose corners lie on a conic. Small against 1; not tuned.
  double regular = 1e-4;
  /// The iteration ends when no eigenvalue changes by more than this fraction, or after so many rounds, count. Round
  /// values, not tuned.
  double convergence = 1e-8;
  int most_rounds = 400;
  /// Shift that makes the matrix positive definite, in units of the bending stiffness: far below the first eigenvalue, which is
  /// about 500 for a free square.
  double shift = 5;
};
constexpr ModeTuning kTuning{};

using Vector = Eigen::Vector3d;
using Matrix = Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

class ModeProblem {
 public:
  ModeProblem(const BendingMesh& mesh, int count) : mesh_(mesh), count_(count) {
    normalise();
    number_unknowns();
    add_energy();
    check_areas();
    const auto n = static_cast<Eigen::Index>(unknowns_);
    stiffness_.resize(n, n);
    stiffness_.setFromTriplets(entries_.begin(), entries_.end());
    entries_ = {};
  }

  BendingModes run(float stiffness) {
    find_rigid_motions();
    const auto available = static_cast<Eigen::Index>(unknowns_) - rigid_.cols();
    const Eigen::Index wanted = std::min(static_cast<Eigen::Index>(count_), available);
    if (wanted <= 0) return {};
    iterate(wanted, std::min(2 * wanted + 8, available));
    BendingModes modes;
    const double first =
        kTuning.first_mode * diagonal_ * std::sqrt(mass_.sum() / 3 / static_cast<double>(stiffness));
    for (Eigen::Index k = 0; k < wanted; ++k) {
      block_.col(k) = with_fixed_sign(block_.col(k));
      size_.push_back(first * std::sqrt(value_(0) / value_(k)));
      modes.eigenvalue.push_back(value_(k));
      modes.displacement.push_back(displacement_of(size_.back() * block_.col(k)));
    }
    add_corrections(modes);
    return modes;
  }

 private:
  /// Scales the surface to a diagonal of 1.
  void normalise() {
    const BoundingBox<Vec3> box(mesh_.position);
    const Vec3 low = box.low;
    diagonal_ = std::max(1e-12, static_cast<double>(length(box.size())));
    for (const Vec3 p : mesh_.position)
      position_.push_back(Vector(static_cast<double>(p.x - low.x), static_cast<double>(p.y - low.y),
                                 static_cast<double>(p.z - low.z)) /
                          diagonal_);
  }

  void number_unknowns() {
    std::vector<char> is_used(position_.size(), 0);
    for (const auto& t : mesh_.triangles)
      for (const int v : t) is_used[at(v)] = 1;
    for (std::size_t v = 0; v < position_.size(); ++v) {
      const bool moves = is_used[v] && !mesh_.is_fixed[v];
      first_unknown_.push_back(moves ? static_cast<int>(unknowns_) : -1);
      unknowns_ += moves ? 3 : 0;
    }
    mass_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns_));
  }

  /// A vertex without area has no stiffness either: nothing tells how it moves.
  void check_areas() const {
    for (std::size_t v = 0; v < position_.size(); ++v)
      if (first_unknown_[v] >= 0 && !(mass_(first_unknown_[v]) > 0)) {
        const Vec3 p = mesh_.position[v];
        throw std::runtime_error(
            "the faces at the vertex at (" + short_text(p.x) + ", " + short_text(p.y) + ", " +
            short_text(p.z) + ") mm have no area: remove it, or move it off the line between its neighbours");
      }
  }

  /// A linear form of the displacements of some vertices.
  using Form = std::vector<std::pair<int, Vector>>;

  /// Adds the energy 1/2 sum of q(i,k) f_i f_k.
  void add_forms(const std::vector<Form>& forms, const Eigen::Matrix3d& q) {
    for (std::size_t i = 0; i < forms.size(); ++i)
      for (std::size_t k = 0; k < forms.size(); ++k)
        for (const auto& [v, g] : forms[i])
          for (const auto& [w, h] : forms[k]) {
            const int row = first_unknown_[at(v)], column = first_unknown_[at(w)];
            if (row < 0 || column < 0 || row < column) continue;  // the lower triangle
            const double weight = q(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
            for (int a = 0; a < 3; ++a)
              for (int b = 0; b < 3; ++b)
                if (row > column || a >= b) entries_.emplace_back(row + a, column + b, weight * g(a) * h(b));
          }
  }

  void add_energy() {
    std::map<std::pair<int, int>, std::vector<int>> opposite;  // of each edge
    for (const auto& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        opposite[std::minmax(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
    for (const auto& t : mesh_.triangles) {
      const Vector &a = position_[at(t[0])], &b = position_[at(t[1])], &c = position_[at(t[2])];
      const Vector normal = (b - a).cross(c - a);
      const double area = 0.5 * normal.norm();
      if (area < 1e-12) continue;
      for (const int v : t)
        if (first_unknown_[at(v)] >= 0) mass_.segment<3>(first_unknown_[at(v)]).array() += area / 3;
      const Vector x = (b - a).normalized(), y = normal.normalized().cross(x);
      add_membrane(t, x, y, area);
      std::vector<Form> angles;
      std::vector<Eigen::Vector3d>
          by_curvature;  // each angle's change by unit curvatures along x, along y and of twist
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = t[k], to = t[(k + 1) % 3], own = t[(k + 2) % 3];
        const int other = neighbour(opposite.at(std::minmax(from, to)), own, from, to);
        if (other >= 0) add_angle({own, other, from, to}, a, x, y, angles, by_curvature);
      }
      if (!angles.empty()) add_bending(angles, by_curvature, area);
    }
  }

  /// The corner, of those opposite an edge, with which the surface goes on straightest from the corner `own`; -1 if there is none.
  /// At an edge of more than two triangles leaves meet, as pages at a spine, or both sides of a card without thickness.
  int neighbour(const std::vector<int>& corners, int own, int from, int to) const {
    const Vector start = position_[at(from)], along = (position_[at(to)] - start).normalized();
    const auto away = [&](int corner) {
      const Vector d = position_[at(corner)] - start;
      return (d - along.dot(d) * along).normalized();
    };
    int best = -1;
    double least = 2;
    for (const int corner : corners) {
      const double cosine = corner == own ? 2 : away(own).dot(away(corner));
      if (cosine < least) best = corner, least = cosine;
    }
    return best;
  }

  /// Material law of a plate for values along x, along y and mixed.
  static Eigen::Matrix3d law(double mixed) {
    Eigen::Matrix3d w;
    w << 1, kTuning.poisson, 0, kTuning.poisson, 1, 0, 0, 0, mixed * (1 - kTuning.poisson);
    return w;
  }

  /// A triangle in its own plane.
  struct Element {
    std::array<int, 3> corner;
    Vector x, y;  // axes
    double area;
    Eigen::Matrix<double, 2, 3>
        slope;  // along x and y, of the function that is 1 in this corner and 0 in the others
  };

  void add_membrane(const std::array<int, 3>& t, const Vector& x, const Vector& y, double area) {
    std::vector<Form> strain(3);
    Element element{t, x, y, area, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector e = position_[at(t[(k + 2) % 3])] - position_[at(t[(k + 1) % 3])];
      const double gx = -e.dot(y) / (2 * area), gy = e.dot(x) / (2 * area);
      strain[0].push_back({t[k], gx * x});
      strain[1].push_back({t[k], gy * y});
      strain[2].push_back({t[k], gy * x + gx * y});
      element.slope.col(static_cast<Eigen::Index>(k)) << gx, gy;
    }
    elements_.push_back(element);
    add_forms(strain, area * law(0.5));
  }

  /// Gradients of the angle at the edge from x[2] to x[3] between the triangles with corners x[0] and x[1]. False if one has no
  /// area.
  static bool angle_gradient(const std::array<Vector, 4>& x, std::array<Vector, 4>& g) {
    const Vector e = x[3] - x[2], n1 = (x[0] - x[2]).cross(x[0] - x[3]),
                 n2 = (x[1] - x[3]).cross(x[1] - x[2]);
    const double length = e.norm();
    if (length < 1e-9 || n1.norm() < 1e-14 || n2.norm() < 1e-14) return false;
    const Vector m1 = n1 / n1.squaredNorm(), m2 = n2 / n2.squaredNorm(), along = e / length;
    g = {length * m1, length * m2, (x[0] - x[3]).dot(along) * m1 + (x[1] - x[3]).dot(along) * m2,
         -(x[0] - x[2]).dot(along) * m1 - (x[1] - x[2]).dot(along) * m2};
    return true;
  }

  /// Adds the change of angle at an edge, and what it would be if the two triangles lay in the plane of the first.
  void add_angle(const std::array<int, 4>& v, const Vector& origin, const Vector& x, const Vector& y,
                 std::vector<Form>& angles, std::vector<Eigen::Vector3d>& by_curvature) const {
    std::array<Vector, 4> place, flat, g;
    for (std::size_t i = 0; i < 4; ++i) place[i] = position_[at(v[i])];
    if (!angle_gradient(place, g)) return;
    const Vector along = (place[3] - place[2]).normalized(), out = place[1] - place[2];
    const Vector inwards = (place[0] - place[2]) - along.dot(place[0] - place[2]) * along;
    const double height = (out - along.dot(out) * along).norm();
    place[1] = place[2] + along.dot(out) * along - height * inwards.normalized();  // unfolded
    for (std::size_t i = 0; i < 4; ++i) flat[i] = {(place[i] - origin).dot(x), (place[i] - origin).dot(y), 0};
    std::array<Vector, 4> lift;
    if (!angle_gradient(flat, lift)) return;
    Eigen::Vector3d row = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i)
      row += lift[i].z() * Eigen::Vector3d(0.5 * flat[i].x() * flat[i].x(), 0.5 * flat[i].y() * flat[i].y(),
                                           flat[i].x() * flat[i].y());
    Form form;
    for (std::size_t i = 0; i < 4; ++i) form.push_back({v[i], g[i]});
    angles.push_back(std::move(form));
    by_curvature.push_back(row);
  }

  /// The least energy of a constant curvature that has these angles. At a free edge there is no angle, and so no moment.
  void add_bending(const std::vector<Form>& angles, const std::vector<Eigen::Vector3d>& by_curvature,
                   double area) {
    Eigen::Matrix3d b = Eigen::Matrix3d::Zero();  // rows beyond the angles stay so: they change no other's entries
    for (std::size_t k = 0; k < angles.size(); ++k) b.row(static_cast<Eigen::Index>(k)) = by_curvature[k];
    Eigen::Matrix3d compliance = b * law(2).inverse() * b.transpose();
    compliance.diagonal().array() += kTuning.regular * compliance.trace();
    const double bending = kTuning.thickness * kTuning.thickness / 12;
    add_forms(angles, bending * area * compliance.inverse());
  }

  /// Fills rigid_ with an orthonormal basis of the rigid motions of all parts of the surface that are not held.
  void find_rigid_motions() {
    std::vector<int> part(position_.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&part](int v) {
      while (part[at(v)] != v) v = part[at(v)] = part[at(part[at(v)])];
      return v;
    };
    for (const auto& t : mesh_.triangles)
      for (const int v : t) part[at(root(v))] = root(t[0]);
    std::map<int, bool> is_held;
    for (std::size_t v = 0; v < position_.size(); ++v)
      is_held[root(static_cast<int>(v))] |= mesh_.is_fixed[v] != 0;
    std::vector<Eigen::VectorXd> motions;
    for (const auto& [first, held] : is_held) {
      for (int k = 0; k < 6 && !held; ++k) {
        Eigen::VectorXd u = Eigen::VectorXd::Zero(mass_.size());
        for (std::size_t v = 0; v < position_.size(); ++v) {
          if (first_unknown_[v] < 0 || root(static_cast<int>(v)) != first) continue;
          const Vector axis = Vector::Unit(k % 3);
          u.segment<3>(first_unknown_[v]) =
              k < 3 ? axis : axis.cross(position_[v] - position_[at(first)]).eval();
        }
        for (int twice = 0; twice < 2; ++twice)
          for (const auto& w : motions) u -= w.dot(mass_.cwiseProduct(u)) * w;
        const double norm = std::sqrt(u.dot(mass_.cwiseProduct(u)));
        if (norm > 1e-9) motions.push_back(u / norm);
      }
    }
    rigid_.resize(mass_.size(), static_cast<Eigen::Index>(motions.size()));
    for (std::size_t k = 0; k < motions.size(); ++k) rigid_.col(static_cast<Eigen::Index>(k)) = motions[k];
  }

  /// Each column times the mass.
  Matrix weighed(const Matrix& block) const { return mass_.asDiagonal() * block; }

  static Matrix products(const Matrix& a, const Matrix& b) { return a.transpose() * b; }

  void remove_rigid(Matrix& block) const { block -= rigid_ * products(rigid_, weighed(block)); }

  void iterate(Eigen::Index wanted, Eigen::Index size) {
    Sparse shifted = stiffness_;
    const double shift = kTuning.shift * kTuning.thickness * kTuning.thickness / 12;
    for (Eigen::Index k = 0; k < shifted.rows(); ++k) shifted.coeffRef(k, k) += shift * mass_(k);
    factors_.compute(shifted);
    if (factors_.info() != Eigen::Success)
      throw std::runtime_error("the stiffness of the surface cannot be factorised");
    block_.resize(mass_.size(), size);
    std::uint32_t state = 12345;  // a fixed pseudo-random start
    for (Eigen::Index c = 0; c < size; ++c)
      for (Eigen::Index r = 0; r < mass_.size(); ++r)
        block_(r, c) = static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / (1 << 23) - 1;
    Eigen::VectorXd before = Eigen::VectorXd::Zero(wanted);
    for (int round = 0; round < kTuning.most_rounds; ++round) {
      block_ = factors_.solve(weighed(block_)).eval();
      remove_rigid(block_);
      for (Eigen::Index c = 0; c < size; ++c) block_.col(c).normalize();
      const Matrix forces = stiffness_.selfadjointView<Eigen::Lower>() * block_;
      const SymmetricEigen eigen = symmetric_eigen(products(block_, forces), products(block_, weighed(block_)));
      value_ = eigen.values.cwiseMax(1e-30);
      block_ = (block_ * eigen.vectors).eval();
      const Eigen::VectorXd now = value_.head(wanted);
      if (((now - before).cwiseAbs().array() <= kTuning.convergence * now.array()).all()) return;
      before = now;
    }
  }

  /// Bending stretches a sheet by the squares of its slopes. The correction of two modes is the displacement that takes back, with
  /// least energy, the strain which belongs to the product of their values (docs/algorithms.md, section 3.8).
  void add_corrections(BendingModes& modes) const {
    for (std::size_t i = 0; i < size_.size(); ++i)
      for (std::size_t k = i; k < size_.size(); ++k) {
        Eigen::VectorXd c = factors_.solve(-second_order_force(i, k));
        c -= rigid_ * (rigid_.transpose() * mass_.cwiseProduct(c));
        for (Eigen::Index m = 0; m < static_cast<Eigen::Index>(size_.size()); ++m)
          c -= block_.col(m).dot(mass_.cwiseProduct(c)) * block_.col(m);
        c *= size_[i] * size_[k] / diagonal_;
        const double moved = std::sqrt(3 * c.dot(mass_.cwiseProduct(c)) / mass_.sum()) / diagonal_;
        if (moved >= kTuning.least_correction) modes.corrections.push_back({i, k, displacement_of(c)});
      }
  }

  /// The forces of the Green strain's part that is bilinear in two modes.
  Eigen::VectorXd second_order_force(std::size_t i, std::size_t k) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(mass_.size());
    for (const Element& e : elements_) {
      const Eigen::Matrix<double, 3, 2> a = gradient(e, i), b = gradient(e, k);
      Eigen::Vector3d strain(a.col(0).dot(b.col(0)), a.col(1).dot(b.col(1)),
                             a.col(0).dot(b.col(1)) + a.col(1).dot(b.col(0)));
      if (i == k) strain *= 0.5;
      const Eigen::Vector3d stress = e.area * law(0.5) * strain;
      for (int corner = 0; corner < 3; ++corner) {
        const int row = first_unknown_[at(e.corner[at(corner)])];
        if (row < 0) continue;
        const double gx = e.slope(0, corner), gy = e.slope(1, corner);
        force.segment<3>(row) +=
            (gx * stress(0) + gy * stress(2)) * e.x + (gy * stress(1) + gx * stress(2)) * e.y;
      }
    }
    return force;
  }

  /// A mode's derivatives along a triangle's x and y.
  Eigen::Matrix<double, 3, 2> gradient(const Element& e, std::size_t mode) const {
    Eigen::Matrix<double, 3, 2> d = Eigen::Matrix<double, 3, 2>::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      const int row = first_unknown_[at(e.corner[at(corner)])];
      if (row >= 0)
        d += block_.col(static_cast<Eigen::Index>(mode)).segment<3>(row) * e.slope.col(corner).transpose();
    }
    return d;
  }

  /// The sign for which the largest entry is positive.
  static Eigen::VectorXd with_fixed_sign(const Eigen::VectorXd& u) {
    Eigen::Index largest = 0;
    u.cwiseAbs().maxCoeff(&largest);
    return u(largest) < 0 ? Eigen::VectorXd(-u) : u;
  }

  std::vector<Vec3> displacement_of(const Eigen::VectorXd& u) const {
    std::vector<Vec3> result(position_.size());
    for (std::size_t v = 0; v < result.size(); ++v) {
      const int k = first_unknown_[v];
      if (k < 0) continue;
      result[v] = {static_cast<float>(u(k)), static_cast<float>(u(k + 1)), static_cast<float>(u(k + 2))};
    }
    return result;
  }

  const BendingMesh& mesh_;
  const int count_;
  double diagonal_ = 1;
  std::vector<Vector> position_;    // for a diagonal of 1
  std::vector<int> first_unknown_;  // of a vertex; -1 if it does not move
  std::size_t unknowns_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
  Sparse stiffness_;      // lower triangle
  Eigen::VectorXd mass_;  // of each unknown
  Matrix rigid_, block_;  // columns, orthonormal with respect to the mass
  Eigen::VectorXd value_;
  std::vector<double> size_;  // of each mode at one standard deviation
  std::vector<Element> elements_;
  Eigen::SimplicialLDLT<Sparse> factors_;  // of the shifted stiffness
};

}  // namespace

BendingModes find_bending_modes(const BendingMesh& mesh, int count, float stiffness) {
  if (mesh.position.empty() || mesh.position.size() > kMostModeVertices) return {};
  return ModeProblem(mesh, count).run(stiffness);
}

}  // namespace pliant::host::bake
