#include "textured_model.hpp"

TexturedModel::TexturedModel() = default;
TexturedModel::~TexturedModel() = default;

pliant::Vec3 TexturedModel::sheet_with_nose(float u, float v) {
  const float x = 2 * u - 1, y = 1 - 2 * v;
  const float nose = pliant::max(0.0f, 1 - 8 * (x * x + y * y));
  return pliant::Vec3{60 * x, 80 * y, -35 * x * x - 20 * y * y + 20 * nose * nose};
}

float TexturedModel::blotches(float u, float v) {
  const auto wave = [](float t) {
    t -= static_cast<float>(static_cast<int>(t));
    return 16 * t * t * (1 - t) * (1 - t);
  };
  return 60 + 90 * wave(3 * u + 0.3f * v) * wave(4 * v + 0.2f * u) +
         70 * wave(9 * u + 2 * v) * wave(11 * v - 2 * u + 4);
}

pliant::host::bake::FieldGrid TexturedModel::grid(int side, const Shape& shape) {
  pliant::host::bake::FieldGrid out;
  out.width = out.height = side;
  out.components = 3;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const pliant::Vec3 p = shape(static_cast<float>(i) / static_cast<float>(side - 1),
                                   static_cast<float>(j) / static_cast<float>(side - 1));
      out.samples.insert(out.samples.end(), {p.x, p.y, p.z});
    }
  return out;
}

TexturedModel::Shape TexturedModel::bump(float u0, float v0, float radius, pliant::Vec3 direction) {
  return [=](float u, float v) {
    const float t = pliant::max(0.0f, 1 - ((u - u0) * (u - u0) + (v - v0) * (v - v0)) / (radius * radius));
    return (t * t) * direction;
  };
}

std::vector<std::string> TexturedModel::landmark_names() {
  std::vector<std::string> names(15);
  names[1] = "eye_right";
  names[3] = "eye_left";
  names[7] = "nose_tip";
  names[11] = "mouth_right";
  names[13] = "mouth_left";
  int number = 0;
  for (std::string& name : names)
    if (name.empty()) name = "ibug0" + std::to_string(number++);
  return names;
}

std::vector<std::uint8_t> TexturedModel::bytes() const {
  using namespace pliant;
  host::bake::TableWriter writer;
  CascadeRecord first = host::bake::empty_record(Operation::constant);
  first.field = writer.add_field(grid(65, rest), 16);
  std::uint16_t last = writer.add_record(first);
  const auto add = [&](const char* name, Group group, float low, const Shape& shape) {
    CascadeRecord r = host::bake::empty_record(Operation::add_vector);
    r.source[0] = last;
    r.parameter[0] = writer.add_parameter(
        {name, group, low, group == Group::identity ? 3.0f : 1.0f, group == Group::identity ? 1.0f : 0.4f});
    r.field = writer.add_field(grid(33, shape), 16);
    last = writer.add_record(r);
  };
  add("width", Group::identity, -3, [](float u, float) { return Vec3{4 * (2 * u - 1), 0, 0}; });
  if (with_expressions) {
    add("browUpLeft", Group::expression, 0, bump(0.7f, 0.3f, 0.25f, {0, 12, 2}));
    add("browUpRight", Group::expression, 0, bump(0.3f, 0.3f, 0.25f, {0, 12, 2}));
    add("jawOpen", Group::expression, 0, bump(0.5f, 0.8f, 0.35f, {0, -16, 0}));
  }
  const auto names = landmark_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto column = static_cast<float>(k % 5), row = static_cast<float>(k / 5);
    writer.add_landmark({names[k], {0.14f + 0.18f * column, 0.2f + 0.3f * row}});
  }
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;
  constexpr int n = 6;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) uv.push_back({static_cast<float>(i) / n, static_cast<float>(j) / n});
  const auto at = [](int i, int j) { return static_cast<std::uint16_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)  // the diagonal is the subdivision edge of both
      corners.insert(corners.end(),
                     {at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i, j + 1)});
  writer.set_base_mesh(uv, corners);
  writer.set_mask({2, 2, {1, 1, 1, 1}});
  host::bake::GreyImage albedo;
  albedo.width = albedo.height = static_cast<std::uint32_t>(albedo_side);
  for (int j = 0; j < albedo_side; ++j)
    for (int i = 0; i < albedo_side; ++i)
      albedo.pixels.push_back(
          static_cast<std::uint8_t>(paint(static_cast<float>(i) / static_cast<float>(albedo_side - 1),
                                          static_cast<float>(j) / static_cast<float>(albedo_side - 1))));
  writer.set_albedo(albedo);
  writer.set_print(print);
  return writer.bytes();
}
