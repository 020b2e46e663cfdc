#include "host/learn/brow_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/io/ibug_names.hpp"
#include "host/learn/mipmap.hpp"

namespace pliant::host::learn {

namespace {

/// Lengths as fractions of the distance between the outer eye corners. Chosen by eye on fitted portraits.
struct BrowSearchTuning {
  float low = 0.19f, high = -0.09f;       ///< range of the move, down positive
  float usual = 0.08f, usual_sd = 0.05f;  ///< the move that is expected, and its standard deviation
  float uneven_sd = 0.02f;                ///< difference of the moves of both brows
  float tilt_sd = 0.035f,
        bend_sd = 0.02f;     ///< of the ends against each other, and of the middle against the ends
  /// Tilts and bends that are tried: steps either way, count, some 1.6 deviations, and their length. Round values.
  int tilt_steps = 6, bend_steps = 3;
  float shape_step = 0.01f;
  float half_band = 0.024f;  ///< half of a brow's height
  float lid_gap = 0.055f;    ///< of a brow's middle above the upper lid, at least
  float prior =
      0.12f;  ///< weight of the deviations against the contrast of the band, in standard deviations of grey
  /// Of the landmarks over the middle of the band: annotators of iBUG's scheme follow its upper edge. Chosen: docs/experiments.md,
  /// Samples.
  float above_middle = 0.034f;
};
constexpr BrowSearchTuning kTuning{};

constexpr std::size_t kColumns = 9, kRows = 57;
constexpr float kRowStep = 0.005f;

/// Axes of the upright face: origin between the outer eye corners, unit their distance.
struct FaceAxes {
  Vec2 origin, right, down;
  Vec2 to_image(Vec2 p) const { return origin + p.x * right + p.y * down; }
  Vec2 from_image(Vec2 x) const {
    const float n = 1 / dot(right, right);
    return {n * dot(x - origin, right), n * dot(x - origin, down)};
  }
};

/// How a brow differs from the fitted one.
struct BrowChange {
  float move = 0, tilt = 0, bend = 0;
  float at(float t) const { return move + tilt * t + bend * (t * t - 0.5f); }
};

struct ScoredChange {
  BrowChange change;
  float score = -1e9f;
};

/// The pair that is best together: brows are about equally high.
std::array<BrowChange, 2> best_pair(const std::array<ScoredChange, kRows>& right,
                                    const std::array<ScoredChange, kRows>& left) {
  std::array<BrowChange, 2> best;
  float best_score = -1e9f;
  for (const ScoredChange& r : right)
    for (const ScoredChange& l : left) {
      const float apart = (r.change.move - l.change.move) / kTuning.uneven_sd;
      const float score = r.score + l.score - kTuning.prior * apart * apart;
      if (score > best_score) best_score = score, best = {r.change, l.change};
    }
  return best;
}

class BrowSearch {
 public:
  BrowSearch(const Mipmap& picture, const FaceAxes& axes) : picture_(picture), axes_(axes) {
    detail_ = picture.detail_for(1);
  }

  /// The best change for each move, with its score.
  /// \param brow  the five landmarks from one end to the other, in face axes. \param lid  height of the upper lid.
  std::array<ScoredChange, kRows> find(const std::array<Vec2, 5>& brow, float lid) {
    measure_contrast(brow);
    std::array<ScoredChange, kRows> best;
    for (std::size_t a = 0; a < kRows; ++a)
      for (int b = -kTuning.tilt_steps; b <= kTuning.tilt_steps; ++b)
        for (int c = -kTuning.bend_steps; c <= kTuning.bend_steps; ++c) {
          const BrowChange change{kTuning.high + kRowStep * static_cast<float>(a),
                                  kTuning.shape_step * static_cast<float>(b),
                                  kTuning.shape_step * static_cast<float>(c)};
          if (brow[2].y + change.at(0) > lid - kTuning.lid_gap) continue;
          if (const float s = score(change); s > best[a].score) best[a] = {change, s};
        }
    return best;
  }

  static Vec2 along(const std::array<Vec2, 5>& brow, float t) {
    const float k = clamp(2 * (t + 1), 0, 3.999f);
    const auto i = static_cast<std::size_t>(k);
    return brow[i] + (k - static_cast<float>(i)) * (brow[i + 1] - brow[i]);
  }

 private:
  float grey(Vec2 p) const { return picture_.at(axes_.to_image(p), detail_); }
  /// Mean over a small stretch of a row.
  float stretch(Vec2 p) const { return (grey({p.x - 0.02f, p.y}) + grey(p) + grey({p.x + 0.02f, p.y})) / 3; }

  void measure_contrast(const std::array<Vec2, 5>& brow) {
    // Sums of grey from the first row on, a column.
    constexpr int kReach = 12;  // rows above and below
    float sum = 0, squares = 0;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const float t = 0.9f * (static_cast<float>(column) / 4 - 1);
      const Vec2 p = along(brow, t);
      std::array<float, kRows + 2 * kReach + 1> total{};
      for (std::size_t row = 0; row + 1 < total.size(); ++row) {
        const float y = p.y + kTuning.high + kRowStep * (static_cast<float>(row) - kReach);
        const float g = stretch({p.x, y});
        total[row + 1] = total[row] + g;
        sum += g, squares += g * g;
      }
      const auto half = static_cast<std::size_t>(kTuning.half_band / kRowStep + 0.5f);
      const auto mean = [&](std::size_t from, std::size_t count) {
        return (total[from + count] - total[from]) / static_cast<float>(count);
      };
      for (std::size_t row = 0; row < kRows; ++row) {
        const std::size_t middle = row + kReach;
        const float band = mean(middle - half, 2 * half + 1), above = mean(middle - 2 * half - 2, half + 1),
                    below = mean(middle + half + 2, half + 1);
        // Dark against both sides; the weaker side counts more.
        contrast_[column][row] = 0.5f * (above + below) - band + 0.5f * (min(above, below) - band);
      }
    }
    const float count = static_cast<float>(kColumns * (kRows + 2 * kReach));
    const float sd = std::sqrt(std::max(squares / count - sum * sum / (count * count), 4.0f));
    for (auto& column : contrast_)
      for (float& c : column) c /= sd;
  }

  float score(const BrowChange& change) const {
    float sum = 0;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const float t = 0.9f * (static_cast<float>(column) / 4 - 1);
      const float row = (change.at(t) - kTuning.high) / kRowStep;
      if (row < 0 || row > static_cast<float>(kRows - 1)) return -1e9f;
      sum += contrast_[column][static_cast<std::size_t>(row + 0.5f)];
    }
    const auto squared = [](float x) { return x * x; };
    return sum / static_cast<float>(kColumns) -
           kTuning.prior * (squared((change.move - kTuning.usual) / kTuning.usual_sd) +
                            squared(change.tilt / kTuning.tilt_sd) + squared(change.bend / kTuning.bend_sd));
  }

  const Mipmap& picture_;
  FaceAxes axes_;
  Mipmap::Detail detail_;
  std::array<std::array<float, kRows>, kColumns> contrast_{};
};

}  // namespace

std::vector<AnnotatedLandmark> find_brows(const Model& model, const Photograph& fitted) {
  const auto number = [&](int k) { return model.find_landmark(ibug_name(k).c_str()); };
  for (const int k : {17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 36, 37, 38, 43, 44, 45})
    if (number(k) == kNone) return {};
  const auto at = [&](int k) { return fitted.landmarks[number(k)]; };
  const Vec2 right = at(45) - at(36);
  const FaceAxes axes{0.5f * (at(36) + at(45)), right, {-right.y, right.x}};
  const Mipmap picture(fitted.picture);
  const auto brow_from = [&](int first) {
    std::array<Vec2, 5> brow;
    for (int k = 0; k < 5; ++k) brow[static_cast<std::size_t>(k)] = axes.from_image(at(first + k));
    return brow;
  };
  const std::array<Vec2, 5> brows[] = {brow_from(17), brow_from(22)};
  BrowSearch search(picture, axes);
  const auto right_changes = search.find(brows[0], axes.from_image(0.5f * (at(37) + at(38))).y);
  const auto left_changes = search.find(brows[1], axes.from_image(0.5f * (at(43) + at(44))).y);
  const std::array<BrowChange, 2> changes = best_pair(right_changes, left_changes);
  std::vector<AnnotatedLandmark> found;
  for (std::size_t side = 0; side < 2; ++side)
    for (int k = 0; k < 5; ++k) {
      Vec2 p = brows[side][static_cast<std::size_t>(k)];
      p.y += changes[side].at(0.5f * static_cast<float>(k) - 1) - kTuning.above_middle;
      found.push_back({model.landmarks()[number((side == 0 ? 17 : 22) + k)].name, axes.to_image(p)});
    }
  return found;
}

}  // namespace pliant::host::learn
