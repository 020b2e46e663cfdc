// Positions and Jacobians a second at 1,900 surface points, from cached samples and from the tables, for several numbers of
// active fields, and the time that a personalised identity saves. The fields are synthetic: each covers the whole chart.
#include <cmath>

#include "host/bake/opened_table.hpp"
#include "host/bake/table_writer.hpp"
#include "host/bench/bench.hpp"
#include "host/bench/random.hpp"
#include "host/bench/rows.hpp"
#include "host/io/owned.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host {

namespace {

constexpr std::size_t kPoints = 1900;
constexpr int kRuns = 9;

/// A rest shape and `fields` vector fields of 128 x 128 samples in 16 bits. The first `identities` have identity parameters.
struct SyntheticModel : bake::OpenedTable {
  SyntheticModel(int fields, int identities) : OpenedTable(table(fields, identities)) {
    require(status(), "synthetic model");
  }

  static std::vector<std::uint8_t> table(int fields, int identities) {
    bake::TableWriter writer;
    CascadeRecord record = bake::empty_record(Operation::constant);
    record.field = writer.add_field(grid(0, 256), 16);
    std::uint16_t last = writer.add_record(record);
    for (int k = 0; k < fields; ++k) {
      const Group group = k < identities ? Group::identity : Group::expression;
      record = bake::empty_record(Operation::add_vector);
      record.source[0] = last;
      record.parameter[0] = writer.add_parameter({"q" + std::to_string(k), group, -3, 3, 1});
      record.field = writer.add_field(grid(k + 1, 128), 16);
      last = writer.add_record(record);
    }
    writer.set_base_mesh({{0, 0}, {0, 1}, {1, 1}}, {2, 0, 1});
    writer.set_mask({1, 1, {1}});
    return writer.bytes();
  }

  static bake::FieldGrid grid(int k, int side) {
    bake::FieldGrid grid;
    grid.width = grid.height = side;
    grid.components = 3;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(side - 1),
                    v = static_cast<float>(j) / static_cast<float>(side - 1);
        for (int c = 0; c < 3; ++c)
          grid.samples.push_back((k == 0 ? 100.0f : 2.0f) * std::sin(static_cast<float>(k % 5 + c + 1) * u +
                                                                     static_cast<float>(2 * c + k % 7) * v));
      }
    return grid;
  }
};

struct Setting {
  std::vector<Vec2> uv;
  std::vector<float> q;

  explicit Setting(const Model& model) {
    BenchRandom random;
    while (uv.size() < kPoints) {
      const Vec2 at{random.unit(), random.unit()};
      if (model.is_on_surface(at)) uv.push_back(at);
    }
    for (std::size_t k = 0; k < model.parameters().count; ++k) q.push_back(random.unit() - 0.4999f);
  }
};

// Results are written here so that the optimiser cannot remove the measured code.
volatile float sink;

void times(const BenchRows& rows, const std::string& name, int fields, double us, double us_jacobian) {
  rows(name, "fields_per_s", 1e6 * static_cast<double>(kPoints) * fields / us);
  rows(name, "us_1900_positions", us);
  rows(name, "jacobians_per_s", 1e6 * static_cast<double>(kPoints) / us_jacobian);
  rows(name, "us_1900_jacobians", us_jacobian);
}

void cached(const BenchRows& rows, Cascade& cascade, const Setting& s, int fields) {
  const std::size_t stride = cascade.samples_per_point();
  std::vector<Vec3> points(kPoints * stride);
  for (std::size_t i = 0; i < kPoints; ++i) cascade.sample_point(s.uv[i], s.q.data(), &points[i * stride]);
  const auto positions = [&] {
    float sum = 0;
    for (std::size_t i = 0; i < kPoints; ++i) sum += cascade.evaluate(&points[i * stride], s.q.data()).x;
    sink = sum;
  };
  const auto jacobians = [&] {
    float sum = 0;
    Jacobian j;
    for (std::size_t i = 0; i < kPoints; ++i)
      sum += cascade.evaluate(&points[i * stride], s.q.data(), &j).x + j.column[j.list[j.count - 1]].x;
    sink = sum;
  };
  times(rows, "cached_" + std::to_string(fields), fields, median_microseconds(positions, kRuns),
        median_microseconds(jacobians, kRuns));
}

/// The positions of all points, from the tables of the fields that act.
float selected_positions(Cascade& cascade, const Setting& s) {
  float sum = 0;
  cascade.select(s.q.data());
  for (const Vec2 uv : s.uv) sum += cascade.selected_point(uv).x;
  return sum;
}

float surface_frames(Cascade& cascade, const Setting& s) {
  float sum = 0;
  for (const Vec2 uv : s.uv) sum += cascade.surface_frame(uv, s.q.data()).pu.x;
  return sum;
}

void resampled(const BenchRows& rows, Cascade& cascade, const Setting& s, int fields, const char* how) {
  std::vector<Vec3> point(cascade.samples_per_point());
  const auto positions = [&] { sink = selected_positions(cascade, s); };
  const auto jacobians = [&] {
    float sum = 0;
    Jacobian j;
    for (const Vec2 uv : s.uv) {
      cascade.sample_point(uv, s.q.data(), point.data());
      sum += cascade.evaluate(point.data(), s.q.data(), &j).x + j.column[j.list[j.count - 1]].x;
    }
    sink = sum;
  };
  const auto frames = [&] { sink = surface_frames(cascade, s); };
  const std::string name = std::string("resampled_") + how + "_" + std::to_string(fields);
  times(rows, name, fields, median_microseconds(positions, kRuns), median_microseconds(jacobians, kRuns));
  rows(name, "us_1900_tangents", median_microseconds(frames, kRuns));
}

/// Time to sample a new point and its tangents.
void new_points(const BenchRows& rows, const std::string& name, Cascade& cascade, const Setting& s) {
  std::vector<Vec3> point(cascade.samples_per_point());
  const auto samples = [&] {
    for (const Vec2 uv : s.uv) cascade.sample_point(uv, s.q.data(), point.data());
    sink = point[0].x;
  };
  const auto frames = [&] { sink = surface_frames(cascade, s); };
  const auto selected = [&] { sink = selected_positions(cascade, s); };
  const double per_point = 1.0 / static_cast<double>(kPoints);
  rows(name, "samples_a_point", static_cast<double>(cascade.sample_count()));
  rows(name, "us_sample_point", per_point * median_microseconds(samples, kRuns));
  rows(name, "us_surface_frame", per_point * median_microseconds(frames, kRuns));
  rows(name, "us_selected_point", per_point * median_microseconds(selected, kRuns));
}

void personalising(const BenchRows& rows, const std::string& model_name, const Model& model) {
  Setting s(model);
  BenchRandom random;
  // A person in the neutral expression: the state in which the mesh is adapted and points are added.
  for (std::size_t k = 0; k < s.q.size(); ++k)
    s.q[k] = model.parameters()[k].group == Group::identity ? 2 * random.unit() - 1 : 0;
  Owned<Cascade> exact(model);
  exact->set_free(Group::expression);
  new_points(rows, model_name + "_identity_sampled", *exact, s);
  for (const std::uint16_t side : {std::uint16_t{32}, std::uint16_t{64}, std::uint16_t{128}}) {
    Owned<Cascade> personalised(model, PersonalFieldLimits{side, side});
    personalised->set_free(Group::expression);
    const auto personalise = [&] { require(personalised->personalise(s.q.data()), "personalise"); };
    const std::string name = model_name + "_identity_personalised_" + std::to_string(side);
    rows(name, "ms_personalise", 1e-3 * median_microseconds(personalise, 3));
    rows(name, "bytes", static_cast<double>(personalised.used_bytes() - exact.used_bytes()));
    double sum = 0;
    float worst = 0;
    for (const Vec2 uv : s.uv) {
      const float off =
          length(personalised->surface_point(uv, s.q.data()) - exact->surface_point(uv, s.q.data()));
      sum += static_cast<double>(off);
      worst = max(worst, off);
    }
    rows(name, "mean_error_mm", sum / static_cast<double>(kPoints));
    rows(name, "max_error_mm", static_cast<double>(worst));
    new_points(rows, name, *personalised, s);
  }
}

}  // namespace

void bench_fields(std::ostream& out, const ModelFile* model) {
  const BenchRows rows(out, "fields");
  for (const int fields : {12, 50, 100}) {
    const SyntheticModel synthetic(fields, 0);
    const Setting s(synthetic.model());
    Owned<Cascade> cascade(synthetic.model());
    cached(rows, *cascade, s, fields);
    resampled(rows, *cascade, s, fields, "bilinear");
    cascade->set_interpolation(Interpolation::bicubic);
    resampled(rows, *cascade, s, fields, "bicubic");
  }
  if (model == nullptr)
    personalising(rows, "synthetic", SyntheticModel(118, 100).model());
  else
    personalising(rows, "model", model->model());
}

}  // namespace pliant::host
