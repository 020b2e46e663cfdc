#include "model_builder.hpp"

#include <cstring>
#include <utility>

ModelBuilder::ModelBuilder() = default;
ModelBuilder::ModelBuilder(const ModelBuilder&) = default;
ModelBuilder::~ModelBuilder() = default;

std::uint16_t ModelBuilder::parameter(const std::string& name, pliant::Group group, float lo, float hi,
                                      float sd) {
  pliant::Parameter p{};
  std::strncpy(p.name, name.c_str(), sizeof p.name - 1);
  p.group = group;
  p.minimum = lo;
  p.maximum = hi;
  p.sd = sd;
  parameters.push_back(p);
  return static_cast<std::uint16_t>(parameters.size() - 1);
}

std::uint16_t ModelBuilder::field(int components, int width, int height, const Function& f, float u0,
                                  float v0, float u1, float v1, bool mirror, int bits) {
  std::vector<float> value;
  float most[3] = {1e-6f, 1e-6f, 1e-6f};
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const pliant::Vec3 p = f(u0 + (u1 - u0) * static_cast<float>(i) / static_cast<float>(width - 1),
                               v0 + (v1 - v0) * static_cast<float>(j) / static_cast<float>(height - 1));
      const float c[3] = {p.x, p.y, p.z};
      for (int k = 0; k < components; ++k) {
        value.push_back(c[k]);
        most[k] = pliant::max(most[k], pliant::magnitude(c[k]));
      }
    }
  pliant::Field out{};
  out.width = static_cast<std::uint16_t>(width);
  out.height = static_cast<std::uint16_t>(height);
  out.components = static_cast<std::uint8_t>(components);
  out.bits = static_cast<std::uint8_t>(bits);
  out.mirror = mirror;
  out.u0 = u0;
  out.v0 = v0;
  out.u1 = u1;
  out.v1 = v1;
  for (int k = 0; k < 3; ++k) out.scale[k] = most[k] / (bits == 16 ? 32767 : 127);
  samples.resize((samples.size() + 1) / 2 * 2);
  out.first_byte = static_cast<std::uint32_t>(samples.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    const float x = value[i] / out.scale[i % static_cast<std::size_t>(components)];
    const auto q = static_cast<std::int16_t>(x < 0 ? x - 0.5f : x + 0.5f);
    const auto bytes = static_cast<std::size_t>(bits / 8);
    samples.resize(samples.size() + bytes);
    std::memcpy(samples.data() + samples.size() - bytes, &q, bytes);  // the low byte comes first
  }
  fields.push_back(out);
  return static_cast<std::uint16_t>(fields.size() - 1);
}

pliant::CascadeRecord& ModelBuilder::record(pliant::Operation operation, std::vector<std::uint16_t> sources,
                                            std::vector<std::uint16_t> q, std::uint16_t field_index,
                                            std::uint16_t weight) {
  pliant::CascadeRecord r{};
  r.operation = operation;
  for (auto& s : r.source) s = pliant::kNone;
  for (auto& p : r.parameter) p = pliant::kNone;
  for (std::size_t i = 0; i < sources.size(); ++i) r.source[i] = sources[i];
  for (std::size_t i = 0; i < q.size(); ++i) r.parameter[i] = q[i];
  r.field = field_index;
  r.weight = weight;
  cascade.push_back(r);
  return cascade.back();
}

void ModelBuilder::landmark(const std::string& name, float u, float v) {
  pliant::Landmark l{};
  std::strncpy(l.name, name.c_str(), sizeof l.name - 1);
  l.u = u;
  l.v = v;
  landmarks.push_back(l);
}

void ModelBuilder::curve(const std::string& name, pliant::CurveKind kind,
                         const std::vector<pliant::Vec2>& points) {
  pliant::Curve c{};
  std::strncpy(c.name, name.c_str(), sizeof c.name - 1);
  c.kind = kind;
  c.first_point = static_cast<std::uint32_t>(curve_points.size());
  c.point_count = static_cast<std::uint32_t>(points.size());
  curves.push_back(c);
  curve_points.insert(curve_points.end(), points.begin(), points.end());
}

void ModelBuilder::grid_mesh(int n) {
  vertices.clear();
  corners.clear();
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      vertices.push_back(
          {static_cast<float>(i) / static_cast<float>(n), static_cast<float>(j) / static_cast<float>(n)});
  const auto at = [n](int i, int j) { return static_cast<std::uint16_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)  // the diagonal is half-edge 0 of both
      for (std::uint16_t c :
           {at(i + 1, j + 1), at(i, j), at(i + 1, j), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        corners.push_back(c);
}

std::vector<std::uint32_t> ModelBuilder::table() const {
  using pliant::table::Kind;
  std::vector<unsigned char> body;
  std::vector<pliant::table::Section> sections;
  const std::pair<Kind, const std::vector<unsigned char>&> optional[] = {
      {Kind::stretch, stretch}, {Kind::detector, detector}, {Kind::aligner, aligner}};
  std::size_t section_count = curves.empty() ? 9 : 10;
  for (const auto& section : optional) section_count += !section.second.empty();
  const std::size_t directory =
      sizeof(pliant::table::Header) + section_count * sizeof(pliant::table::Section);
  const auto add = [&](Kind kind, const void* data, std::size_t count, std::size_t size) {
    while (body.size() % 4 != 0) body.push_back(0);
    sections.push_back(
        {kind, static_cast<std::uint32_t>(directory + body.size()), static_cast<std::uint32_t>(count)});
    const auto* p = static_cast<const unsigned char*>(data);
    body.insert(body.end(), p, p + count * size);
  };
  add(Kind::parameters, parameters.data(), parameters.size(), sizeof(pliant::Parameter));
  add(Kind::fields, fields.data(), fields.size(), sizeof(pliant::Field));
  add(Kind::samples, samples.data(), samples.size(), 1);
  add(Kind::cascade, cascade.data(), cascade.size(), sizeof(pliant::CascadeRecord));
  const unsigned char mask[12] = {2, 0, 0, 0, 2, 0, 0, 0, 1, 1, 1, 1};
  add(Kind::mask, mask, sizeof mask, 1);
  add(Kind::vertices, vertices.data(), vertices.size(), sizeof(pliant::Vec2));
  add(Kind::faces, corners.data(), corners.size(), sizeof(std::uint16_t));
  add(Kind::landmarks, landmarks.data(), landmarks.size(), sizeof(pliant::Landmark));
  add(Kind::curves, curves.data(), curves.size(), sizeof(pliant::Curve));
  if (!curves.empty())
    add(Kind::curve_points, curve_points.data(), curve_points.size(), sizeof(pliant::Vec2));
  for (const auto& [kind, bytes] : optional)
    if (!bytes.empty()) add(kind, bytes.data(), bytes.size(), 1);
  while (body.size() % 4 != 0) body.push_back(0);
  pliant::table::Header h{pliant::table::kMagic, pliant::table::kVersion,
                          static_cast<std::uint32_t>(directory + body.size()), 0,
                          static_cast<std::uint32_t>(sections.size())};
  std::vector<std::uint32_t> words(h.total_bytes / 4);
  auto* out = reinterpret_cast<unsigned char*>(words.data());
  std::memcpy(out + sizeof h, sections.data(), sections.size() * sizeof(pliant::table::Section));
  std::memcpy(out + directory, body.data(), body.size());
  std::memcpy(out, &h, sizeof h);
  h.crc32 = pliant::crc32(out + 16, h.total_bytes - 16);
  std::memcpy(out, &h, sizeof h);
  return words;
}

namespace {

using namespace pliant;

/// The neutral egg: 150 x 200 mm, with a nose.
void add_egg(ModelBuilder& b) {
  const auto egg = [](float u, float v) {
    const float x = 2 * u - 1, y = 1 - 2 * v;
    const float nose = max(0.0f, 1 - 9 * (x * x + (y + 0.1f) * (y + 0.1f)));
    return Vec3{75 * x, 100 * y, 45 * (1 - x * x) + 25 * (1 - y * y) - 30 + 22 * nose * nose};
  };
  b.record(Operation::constant, {}, {}, b.field(3, 65, 65, egg));
}

/// Identity k: waves over the whole surface.
void add_identity(ModelBuilder& b, int k) {
  const float a = 1 + static_cast<float>(k % 3), c = 1 + static_cast<float>(k / 3);
  const auto wave = [=](float u, float v) {
    const auto bump = [](float t) {
      t = t - static_cast<float>(static_cast<int>(t));
      return 16 * t * t * (1 - t) * (1 - t) - 0.5f;
    };
    return Vec3{2 * bump(a * u * 0.5f + 0.2f), 3 * bump(c * v * 0.5f + 0.1f),
                4 * bump(a * u * 0.7f) * bump(c * v * 0.7f)};
  };
  const std::uint16_t q = b.parameter("identity" + std::to_string(k), Group::identity, -3, 3, 1);
  b.record(Operation::add_vector, {b.last()}, {q}, b.field(3, 33, 33, wave));
}

/// A bump on the left, and its mirror image on the right.
void add_bumps(ModelBuilder& b) {
  const auto bump = [](float u, float v) {
    const float t = max(0.0f, 1 - ((u - 0.7f) * (u - 0.7f) + (v - 0.4f) * (v - 0.4f)) / (0.2f * 0.2f));
    return Vec3{6 * t * t, 10 * t * t, 3 * t * t};
  };
  const std::uint16_t left = b.parameter("bumpLeft", Group::expression, 0, 1, 0.4f);
  const std::uint16_t right = b.parameter("bumpRight", Group::expression, 0, 1, 0.4f);
  b.record(Operation::add_vector, {b.last()}, {left}, b.field(3, 33, 33, bump, 0.5f, 0.2f, 0.9f, 0.6f));
  Field mirrored = b.fields.back();
  mirrored.mirror = 1;
  b.fields.push_back(mirrored);
  b.record(Operation::add_vector, {b.last()}, {right}, static_cast<std::uint16_t>(b.fields.size() - 1));
}

/// The lower part turns about a hinge.
void add_jaw(ModelBuilder& b) {
  const std::uint16_t jaw = b.parameter("jawOpen", Group::expression, 0, 0.5f, 0.2f);
  const std::uint16_t w = b.field(1, 17, 33, [](float, float v) {
    const float t = clamp((v - 0.6f) / 0.3f, 0, 1);
    return Vec3{t * t * (3 - 2 * t), 0, 0};
  });
  CascadeRecord& hinge = b.record(Operation::rotate, {b.last()}, {jaw}, kNone, w);
  hinge.axis[0] = 1;
  hinge.pivot[1] = -20;
  hinge.pivot[2] = -60;
}

void add_stretch(ModelBuilder& b) {
  const std::uint16_t stretch = b.parameter("stretch", Group::expression, -0.2f, 0.2f, 0.1f);
  const std::uint16_t all = b.field(1, 9, 9, [](float u, float v) {
    return Vec3{16 * u * (1 - u) * v * (1 - v), 0, 0};
  });
  b.record(Operation::scale, {b.last()}, {stretch}, kNone, all);
}

}  // namespace

ModelBuilder egg_model(int identities) {
  ModelBuilder b;
  add_egg(b);
  for (int k = 0; k < identities; ++k) add_identity(b, k);
  add_bumps(b);
  add_jaw(b);
  add_stretch(b);
  b.grid_mesh(8);
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i)
      b.landmark("p" + std::to_string(i) + std::to_string(j), 0.1f + 0.1f * static_cast<float>(i),
                 0.1f + 0.1f * static_cast<float>(j));
  return b;
}
