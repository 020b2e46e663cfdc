// FAST-MCD (Rousseeuw & Van Driessen 1999; docs/algorithms.md, section 6.2): many cheap random starts, of which few are
// followed to convergence. Starts only have to be ranked, so they run in float.
#include "optim/mcd_state.hpp"

namespace pliant {

namespace mcd {

namespace {

constexpr std::size_t kGroupRows = kTuning.group_rows, kMostUngrouped = 2 * kGroupRows;

/// splitmix64.
struct Generator {
  std::uint64_t state;
  std::size_t below(std::size_t n) {  // n < 2^16: the bias is below 2^-16
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<std::size_t>((((z ^ (z >> 31)) >> 32) * n) >> 32);
  }
};

/// order[first ... last - 1] become a random choice from order[first ... n - 1].
void draw(Generator& generator, std::uint16_t* order, std::size_t first, std::size_t last, std::size_t n) {
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t other = i + generator.below(n - i);
    const std::uint16_t row = order[other];
    order[other] = order[i];
    order[i] = row;
  }
}

/// The best few shapes met, best first; those of one determinant are taken for one.
class Candidates {
 public:
  Candidates(float* pool, std::size_t columns) : columns_(columns) {
    for (std::size_t i = 0; i < kKept; ++i) values_[i] = pool + i * slot_size(columns);
  }
  static std::size_t slot_size(std::size_t columns) { return columns + packed_size(columns); }
  std::size_t count() const { return count_; }

  void offer(const Shape<float>& shape) {
    std::size_t place = count_;
    for (std::size_t i = 0; i < count_; ++i) {
      if (is_close(determinant_[i], shape.determinant, 1e-6)) return;
      if (place == count_ && is_less(shape.determinant, determinant_[i])) place = i;
    }
    if (place == kKept) return;
    if (count_ < kKept) ++count_;
    float* slot = values_[count_ - 1];
    for (std::size_t i = count_ - 1; i > place; --i) {
      values_[i] = values_[i - 1];
      determinant_[i] = determinant_[i - 1];
    }
    values_[place] = slot;
    determinant_[place] = shape.determinant;
    for (std::size_t j = 0; j < columns_; ++j) slot[j] = shape.mean[j];
    for (std::size_t k = 0; k < packed_size(columns_); ++k) slot[columns_ + k] = shape.whitener[k];
  }

  template <class Real>
  void get(std::size_t i, const Shape<Real>& shape) const {
    for (std::size_t j = 0; j < columns_; ++j) shape.mean[j] = static_cast<Real>(values_[i][j]);
    for (std::size_t k = 0; k < packed_size(columns_); ++k)
      shape.whitener[k] = static_cast<Real>(values_[i][columns_ + k]);
  }

 private:
  std::size_t columns_, count_ = 0;
  float* values_[kKept] = {};
  ScaledNumber determinant_[kKept] = {};
};

/// The shape of columns + 1 random rows, of more where those lie in a plane.
void draw_shape(const Cloud& cloud, Generator& generator, std::uint16_t* order, const Scratch& scratch,
                Shape<float>& shape) {
  std::size_t count = 0;
  for (std::size_t next = cloud.columns + 1; count < cloud.rows; next = 2 * count - cloud.columns) {
    if (next > cloud.rows) next = cloud.rows;
    draw(generator, order, count, next, cloud.rows);
    count = next;
    fit_shape(cloud, order, count, scratch, shape);
    if (!shape.singular) return;
  }
}

void two_steps(const Cloud& cloud, std::size_t h, const Scratch& scratch, Shape<float>& shape) {
  c_step(cloud, h, scratch, shape);
  c_step(cloud, h, scratch, shape);
}

/// What random starts use.
struct StartTools {
  Generator& generator;
  std::uint16_t* order;  // a row
  const Scratch& scratch;
};

/// Memory of the groups: their rows, and their candidates.
struct GroupRoom {
  float *rows, *pool;
};

[[gnu::noinline]] void try_starts(const Cloud& cloud, std::size_t h, std::size_t starts,
                                  const StartTools& tools, Candidates& candidates) {
  for (std::size_t i = 0; i < cloud.rows; ++i) tools.order[i] = static_cast<std::uint16_t>(i);
  for (std::size_t start = 0; start < starts; ++start) {
    Shape<float> shape = tools.scratch.float_shape(cloud.columns);
    draw_shape(cloud, tools.generator, tools.order, tools.scratch, shape);
    two_steps(cloud, h, tools.scratch, shape);
    candidates.offer(shape);
  }
}

/// Starts on up to five random groups of about 300 rows, their best on all these rows together.
[[gnu::noinline]] void try_groups(const Cloud& cloud, std::size_t h, std::size_t starts,
                                  const StartTools& tools, const GroupRoom& memory, Candidates& candidates) {
  float* const room = memory.rows;
  std::uint16_t* const order = tools.order;
  const Scratch& scratch = tools.scratch;
  const std::size_t groups = cloud.rows / kGroupRows < kGroups ? cloud.rows / kGroupRows : kGroups;
  const std::size_t rows =
      groups < kGroups || cloud.rows < kGroups * kGroupRows ? cloud.rows : kGroups * kGroupRows;
  for (std::size_t i = 0; i < cloud.rows; ++i) order[i] = static_cast<std::uint16_t>(i);
  draw(tools.generator, order, 0, rows, cloud.rows);
  for (std::size_t j = 0; j < cloud.columns; ++j) {
    for (std::size_t i = 0; i < rows; ++i) room[j * cloud.stride + i] = cloud.z[j * cloud.stride + order[i]];
    for (std::size_t i = rows; i < cloud.stride; ++i) room[j * cloud.stride + i] = 0;
  }
  const Cloud merged{room, cloud.stride, rows, cloud.columns};
  const auto part_of = [&](std::size_t count) { return (count * h + cloud.rows - 1) / cloud.rows; };
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t first = rows * g / groups, count = rows * (g + 1) / groups - first;
    const Cloud group{room + first, cloud.stride, count, cloud.columns};
    Candidates of_group(memory.pool + (g + 1) * kKept * Candidates::slot_size(cloud.columns), cloud.columns);
    try_starts(group, part_of(count), (starts + groups - 1) / groups, tools, of_group);
    for (std::size_t i = 0; i < of_group.count(); ++i) {
      Shape<float> shape = scratch.float_shape(merged.columns);
      of_group.get(i, shape);
      two_steps(merged, part_of(rows), scratch, shape);
      candidates.offer(shape);
    }
  }
}

}  // namespace
}  // namespace mcd

Status Mcd::fast(const float* data, std::size_t rows, std::size_t columns, const McdOptions& options) {
  const Status status = prepare(data, rows, columns, options);
  if (status != Status::ok || state_->active_columns == 0)
    return status == Status::ok ? finish(options) : status;
  mcd::Search search = state_->begin_search(best_);
  mcd::Generator generator{options.seed};
  const mcd::StartTools tools{generator, state_->order, search.scratch};
  mcd::Candidates candidates(state_->candidate_pool, state_->active_columns);
  if (state_->used_rows <= mcd::kMostUngrouped)
    mcd::try_starts(search.cloud, state_->subset_size, options.starts, tools, candidates);
  else
    mcd::try_groups(search.cloud, state_->subset_size, options.starts, tools,
                    {state_->other, state_->candidate_pool}, candidates);
  for (std::size_t i = 0; i < candidates.count(); ++i) {
    mcd::Shape<double> shape = search.scratch.shape(state_->active_columns);
    candidates.get(i, shape);
    search.converge(shape);
  }
  search.exchange(options.exchanges);
  full_steps_ = search.steps;
  return finish(options);
}

}  // namespace pliant
