#include "baked_model.hpp"

#include <doctest/doctest.h>

#include <cstring>

BakedModel::BakedModel(const std::vector<std::uint8_t>& table) : words((table.size() + 3) / 4) {
  std::memcpy(words.data(), table.data(), table.size());
  REQUIRE(pliant::Model::open(words.data(), table.size(), &model) == pliant::Status::ok);
  block = AlignedBlock(pliant::measured_bytes<pliant::Cascade>(model));
  pliant::Arena arena(block.data(), block.size());
  REQUIRE(pliant::create_in(arena, cascade, model) == pliant::Status::ok);
}

BakedModel::~BakedModel() = default;

std::vector<float> BakedModel::rest() const {
  return std::vector<float>(model.parameters().count, 0.0f);
}

std::vector<float> BakedModel::posed(const std::string& name, float fraction) const {
  auto q = rest();
  const auto k = model.find_parameter(name.c_str());
  REQUIRE_MESSAGE(k != pliant::kNone, name);
  q[k] = fraction * model.parameters()[k].maximum;
  return q;
}

pliant::Vec2 BakedModel::uv(const std::string& landmark) const {
  const auto k = model.find_landmark(landmark.c_str());
  REQUIRE_MESSAGE(k != pliant::kNone, landmark);
  return model.landmarks()[k].uv();
}

pliant::Vec3 BakedModel::at(pliant::Vec2 where, const std::vector<float>& q) {
  return cascade.surface_point(where, q.data());
}

pliant::Vec3 BakedModel::at(const std::string& landmark, const std::vector<float>& q) {
  return at(uv(landmark), q);
}
