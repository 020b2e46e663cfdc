#include "opened_egg.hpp"

OpenedEgg::OpenedEgg(int identities) : words(egg_model(identities).table()) {
  REQUIRE(pliant::Model::open(words.data(), words.size() * 4, &model) == pliant::Status::ok);
  q.assign(model.parameters().count, 0.0f);
}
