// `pliant info`: prints the contents of a model table and its memory at run time.
#include <cstdio>
#include <set>

#include "host/commands/command.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/curve_kinds.hpp"
#include "host/io/files.hpp"
#include "host/io/owned.hpp"
#include "model/parameters.hpp"
#include "pliant/cascade.hpp"
#include "pliant/fit.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

namespace {

template <class... Values>
void print(std::ostream& out, const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  out << line;
}

const char* name_of(Operation operation) {
  switch (operation) {
    case Operation::constant:
      return "constant";
    case Operation::add_vector:
      return "add_vector";
    case Operation::product:
      return "product";
    case Operation::one_sided:
      return "one_sided";
    case Operation::scale:
      return "scale";
    case Operation::rotate:
      return "rotate";
    case Operation::affine:
      return "affine";
    case Operation::rigid:
      return "rigid";
    case Operation::lerp:
      return "lerp";
  }
  return "?";
}

const char* name_of(CurveKind kind) {
  const auto k = static_cast<std::size_t>(kind);
  return k < std::size(kCurveKindNames) ? kCurveKindNames[k] : "?";
}

std::size_t sample_bytes(const Field& f) {
  return std::size_t{f.width} * f.height * f.components * (f.bits / 8u);
}

/// Bytes of each part of the table. Mirrored fields have the samples of another field, which are counted once.
void print_bytes(const Model& model, std::ostream& out) {
  std::set<std::uint32_t> seen;
  std::size_t rest = 0, moving = 0;
  for (const CascadeRecord& r : model.cascade()) {
    const std::uint16_t k = r.field != kNone ? r.field : r.weight;
    if (k == kNone || !seen.insert(model.fields()[k].first_byte).second) continue;
    (r.operation == Operation::constant ? rest : moving) += sample_bytes(model.fields()[k]);
  }
  const auto row = [&](const char* what, std::size_t bytes) { print(out, "  %-22s%10zu\n", what, bytes); };
  const auto pixels = [](ChartImage image) { return std::size_t{image.width} * image.height; };
  out << "bytes:\n";
  row("samples, rest shape", rest);
  row("samples, deformations", moving);
  row("fields and cascade",
      model.fields().count * sizeof(Field) + model.cascade().count * sizeof(CascadeRecord));
  row("mask and albedo",
      pixels(model.mask()) + (model.albedo().pixels != nullptr ? pixels(model.albedo()) : 0));
  row("base mesh", model.base_uv().count * sizeof(Vec2) + model.base_corners().count * sizeof(std::uint16_t));
  row("detector", model.detector().count);
  row("aligner", model.aligner().count);
  row("parts", model.parts().count);
  row("stretch", model.stretch().count);
  row("print", model.print().count);
  row("names and curves",
      model.parameters().count * sizeof(Parameter) + model.landmarks().count * sizeof(Landmark) +
          model.curves().count * sizeof(Curve) + model.curve_points().count * sizeof(Vec2));
}

/// Extent of the base mesh at rest.
void print_size(const Model& model, std::ostream& out) {
  Owned<Cascade> cascade(model);
  const std::vector<float> q(model.parameters().count, 0.0f);
  BoundingBox<Vec3> box;
  for (const Vec2 uv : model.base_uv()) box.add(cascade->surface_point(uv, q.data()));
  const Vec3 size = box.size();
  print(out, "size at rest: %.4g x %.4g x %.4g mm\n", static_cast<double>(size.x),
        static_cast<double>(size.y), static_cast<double>(size.z));
}

void print_curves(const Model& model, std::ostream& out) {
  print(out, "curves: %zu\n", model.curves().count);
  for (const Curve& c : model.curves())
    print(out, "  %-28s %-7s %3u points\n", c.name, name_of(c.kind), c.point_count);
}

void print_parameters(const Model& model, Group group, const char* title, std::ostream& out) {
  print(out, "%s parameters: %zu\n", title, count_of(group, model));
  for (const Parameter& p : model.parameters())
    if (p.group == group) {
      print(out, "  %-28s %7.3g to %-7.3g sd %.3g\n", p.name, static_cast<double>(p.minimum),
            static_cast<double>(p.maximum), static_cast<double>(p.sd));
    }
}

void print_fields(const Model& model, std::ostream& out) {
  std::size_t vectors = 0, weights = 0, mirrored = 0, whole = 0, bytes8 = 0;
  for (const Field& f : model.fields()) {
    (f.components == 3 ? vectors : weights) += 1;
    mirrored += f.mirror;
    bytes8 += f.bits == 8 ? 1 : 0;
    whole += f.u0 == 0 && f.v0 == 0 && f.u1 == 1 && f.v1 == 1 ? 1 : 0;
  }
  print(out, "fields: %zu vector, %zu weight; %zu over the whole chart, %zu mirrored, %zu of 8 bits\n",
        vectors, weights, whole, mirrored, bytes8);
  for (std::size_t k = 0; k < model.fields().count; ++k) {
    const Field& f = model.fields()[k];
    print(out, "  %3zu %4u x %-4u %s %2u bits  u %.3f..%.3f  v %.3f..%.3f%s\n", k, f.width, f.height,
          f.components == 3 ? "vector" : "weight", f.bits, static_cast<double>(f.u0),
          static_cast<double>(f.u1), static_cast<double>(f.v0), static_cast<double>(f.v1),
          f.mirror != 0 ? "  mirrored" : "");
  }
}

/// Prints a record, without its source if that is the record before.
void print_record(const Model& model, std::size_t k, std::ostream& out) {
  const CascadeRecord& r = model.cascade()[k];
  print(out, "  %3zu %-10s", k, name_of(r.operation));
  if (r.source[1] != kNone)
    print(out, " of %u and %u", r.source[0], r.source[1]);
  else if (r.source[0] != kNone && r.source[0] + 1u != k)
    print(out, " of %u", r.source[0]);
  if (r.field != kNone) print(out, " field %u", r.field);
  if (r.weight != kNone) print(out, " weight %u", r.weight);
  for (const std::uint16_t p : r.parameter)
    if (p != kNone) print(out, " %s", model.parameters()[p].name);
  const auto vector = [&](const char* what, const float* v) {
    print(out, " %s %g %g %g", what, static_cast<double>(v[0]), static_cast<double>(v[1]),
          static_cast<double>(v[2]));
  };
  if (r.operation == Operation::rotate) vector("about", r.axis);
  if (r.operation == Operation::rotate || r.operation == Operation::rigid || r.operation == Operation::scale)
    vector("through", r.pivot);
  out << "\n";
}

void print_cascade(const Model& model, std::ostream& out) {
  print(out, "cascade: %zu records\n", model.cascade().count);
  for (std::size_t k = 0; k < model.cascade().count; ++k) print_record(model, k, out);
}

void print_memory(const Model& model, std::ostream& out) {
  out << "memory at run time:\n";
  print(out, "  cascade               %8zu bytes\n", measured_bytes<Cascade>(model));
  print(out, "  personal field 128x128%8zu bytes\n",
        measured_bytes<Cascade>(model, PersonalFieldLimits{128, 128}) - measured_bytes<Cascade>(model));
  print(out, "  fit, %3u points       %8zu bytes\n", FitLimits{}.points,
        measured_bytes<Fitter>(model, FitLimits{}));
  const TrackerLimits limits = with_base_mesh({}, model);
  print(out, "  tracker, %3u x %-3u    %8zu bytes (%u patches, %u vertices)\n", limits.width, limits.height,
        measured_bytes<Tracker>(model, limits), static_cast<unsigned>(limits.patches + limits.key_patches),
        limits.vertices);
}

int run_info(const Args& args, Console& console) {
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  std::ostream& out = console.out;
  out << file.path();
  print(out, ": %zu bytes, crc %08x\n", model.table_bytes(), static_cast<unsigned>(model.crc()));
  print_size(model, out);
  print_bytes(model, out);
  print_parameters(model, Group::identity, "identity", out);
  print_parameters(model, Group::expression, "expression", out);
  print_fields(model, out);
  print_cascade(model, out);
  print(out, "base mesh: %zu vertices, %zu faces\n", model.base_uv().count, model.base_corners().count / 3);
  print(out, "mask: %u x %u; albedo: %u x %u\n", model.mask().width, model.mask().height,
        model.albedo().width, model.albedo().height);
  print_curves(model, out);
  print(out, "landmarks: %zu\n ", model.landmarks().count);
  for (const Landmark& l : model.landmarks()) out << " " << l.name;
  out << "\n";
  print_memory(model, out);
  return 0;
}

}  // namespace

Command info_command() {
  return {"info",  "Prints the contents of a model table and its memory at run time.", "face.plm", {}, 1,
          run_info};
}

}  // namespace pliant::host
