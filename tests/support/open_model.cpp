#include "open_model.hpp"

OpenModel::OpenModel(const ModelBuilder& builder) : words(builder.table()) {
  REQUIRE(pliant::Model::open(words.data(), words.size() * 4, &model) == pliant::Status::ok);
}

OpenedEgg::OpenedEgg(int identities) : OpenModel(egg_model(identities)), q(model.parameters().count) {}
