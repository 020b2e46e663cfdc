#include "host/bake/parameter_choice.hpp"

#include <algorithm>
#include <numeric>

#include "host/bake/arkit_names.hpp"
#include "host/bake/at.hpp"
#include "host/bake/source_error.hpp"

namespace pliant::host::bake {

namespace {

/// Name of the expression of the other side; empty for a name without a side.
std::string other_side(const std::string& name) {
  for (const auto& [side, other] : {std::pair<std::string, std::string>{"Left", "Right"}, {"Right", "Left"}})
    if (name.size() > side.size() && name.compare(name.size() - side.size(), side.size(), side) == 0)
      return name.substr(0, name.size() - side.size()) + other;
  return "";
}

/// Sum over the vertices of their motion by a parameter at its farther limit.
float reach(const Source& source, std::size_t parameter) {
  double sum = 0;
  for (const SourceShape& shape : source.shapes)
    if (shape.parameter == parameter && shape.second < 0)
      for (const Vec3 d : shape.displacement) sum += static_cast<double>(length(d));
  return static_cast<float>(sum) * std::abs(source.parameters[parameter].farthest());
}

/// One expression, or the two sides of one: both are chosen or none.
struct Unit {
  std::vector<std::size_t> parameters;
  std::size_t rank;
  float reach;
};

std::vector<Unit> units(const Source& source) {
  std::vector<Unit> result;
  const auto& p = source.parameters;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p[k].group != Group::expression) continue;
    const auto pair = std::find_if(result.begin(), result.end(), [&](const Unit& unit) {
      return p[unit.parameters[0]].name == other_side(p[k].name);
    });
    if (pair == result.end()) {
      result.push_back({{k}, usefulness_rank(p[k].name), reach(source, k)});
    } else {
      pair->parameters.push_back(k);
      pair->rank = std::min(pair->rank, usefulness_rank(p[k].name));
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const Unit& a, const Unit& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.reach > b.reach;
  });
  return result;
}

std::vector<char> chosen(const Source& source, const ParameterChoice& choice) {
  const auto& p = source.parameters;
  std::vector<char> keep(p.size(), 0);
  int identities = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    keep[k] = p[k].group == Group::identity ? choice.identities < 0 || identities++ < choice.identities
                                            : choice.expressions < 0 && choice.named.empty();
  for (const std::string& name : choice.named) {
    const auto found = std::find_if(p.begin(), p.end(), [&](const SourceParameter& q) {
      return q.group == Group::expression && q.name == name;
    });
    if (found == p.end()) throw SourceError("--expressions", 0, "there is no expression '" + name + "'");
    keep[static_cast<std::size_t>(found - p.begin())] = 1;
  }
  if (choice.expressions < 0 || !choice.named.empty()) return keep;
  std::size_t room = at(choice.expressions);
  for (const Unit& unit : units(source)) {
    if (unit.parameters.size() > room) continue;
    room -= unit.parameters.size();
    for (const std::size_t k : unit.parameters) keep[k] = 1;
  }
  return keep;
}

}  // namespace

void choose_parameters(Source& source, const ParameterChoice& choice) {
  const std::vector<char> keep = chosen(source, choice);
  std::vector<std::size_t> parameter_now(keep.size());
  std::vector<int> shape_now;
  std::vector<SourceParameter> parameters;
  for (std::size_t k = 0; k < keep.size(); ++k) {
    parameter_now[k] = parameters.size();
    if (keep[k]) parameters.push_back(source.parameters[k]);
  }
  std::vector<SourceShape> shapes;
  for (SourceShape& shape : source.shapes) {
    const bool stays = keep[shape.parameter] != 0 && (shape.second < 0 || keep[at(shape.second)] != 0);
    shape_now.push_back(stays ? static_cast<int>(shapes.size()) : -1);
    if (!stays) continue;
    if (shape.mirror_of >= 0) {
      const int original = shape_now[at(shape.mirror_of)];
      if (original < 0) {
        const std::string& name = source.parameters[shape.parameter].name;
        throw SourceError("--expressions", 0,
                          name + " is the mirror image of " + other_side(name) + ": name both");
      }
      shape.mirror_of = original;
    }
    shape.parameter = parameter_now[shape.parameter];
    if (shape.second >= 0) shape.second = static_cast<int>(parameter_now[at(shape.second)]);
    shapes.push_back(std::move(shape));
  }
  source.parameters = std::move(parameters);
  source.shapes = std::move(shapes);
}

}  // namespace pliant::host::bake
