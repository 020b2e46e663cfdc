#include "host/render/retarget.hpp"

#include <algorithm>

#include "host/io/failure.hpp"
#include "host/io/words.hpp"
#include "model/parameters.hpp"

namespace pliant::host {

namespace {

bool is_expression(const Model& model, std::uint16_t k) {
  return model.parameters()[k].group == Group::expression;
}

/// Columns and the expression parameters that they drive. A parameter with several columns takes their mean.
class Wiring {
 public:
  Wiring(const CsvTable& table, const Model& model, std::vector<std::string>* unmatched)
      : columns_of_(model.parameters().count) {
    for (std::size_t c = 0; c < table.columns().size(); ++c)
      for (const std::uint16_t k : parameters_named(model, table.columns()[c]))
        if (is_expression(model, k)) columns_of_[k].push_back(c);
    // This model has a single parameter for the pair, which parameters_named does not resolve.
    const auto is_half = [&](const std::string& name) {
      const std::string stem = name.substr(0, name.size() - (ends_with(name, "Left")    ? 4
                                                             : ends_with(name, "Right") ? 5
                                                                                        : 0));
      const std::uint16_t k = stem == name ? kNone : model.find_parameter(stem.c_str());
      if (k == kNone || !is_expression(model, k)) return false;
      columns_of_[k].push_back(*table.find_column(name));
      return true;
    };
    unmatched->erase(std::remove_if(unmatched->begin(), unmatched->end(), is_half), unmatched->end());
  }
  const std::vector<std::size_t>& columns_of(std::size_t k) const { return columns_of_[k]; }
  bool uses(std::size_t column) const {
    return std::any_of(columns_of_.begin(), columns_of_.end(), [column](const auto& of) {
      return std::find(of.begin(), of.end(), column) != of.end();
    });
  }

 private:
  std::vector<std::vector<std::size_t>> columns_of_;
};

/// Maps a value of the source's parameter to the same fraction of the target's range.
float rescaled(float value, const Parameter& from, const Parameter& to) {
  const float low = value < 0 ? from.minimum : from.maximum, high = value < 0 ? to.minimum : to.maximum;
  return low != 0 && high != 0 ? value * high / low : value;
}

/// The values of the columns, row by row; an empty cell repeats the one above.
std::vector<std::vector<float>> read_columns(const CsvTable& table, const Model* source, const Model& model,
                                             const Wiring& wiring) {
  std::vector<std::vector<float>> q(table.row_count(), std::vector<float>(model.parameters().count, 0.0f));
  for (std::size_t k = 0; k < model.parameters().count; ++k) {
    const auto& columns = wiring.columns_of(k);
    std::vector<float> value(columns.size(), 0.0f);
    for (std::size_t r = 0; r < table.row_count(); ++r) {
      float sum = 0;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (!table.cell(r, columns[i]).empty()) {
          value[i] = table.number(r, columns[i]);
          if (source != nullptr)
            for (const std::uint16_t s : parameters_named(*source, table.columns()[columns[i]]))
              value[i] =
                  rescaled(table.number(r, columns[i]), source->parameters()[s], model.parameters()[k]);
        }
        sum += value[i];
      }
      if (!columns.empty()) q[r][k] = sum / static_cast<float>(columns.size());
    }
  }
  return q;
}

/// The columns in use whose names are no parameters of the source.
std::vector<std::string> columns_without_parameter(const CsvTable& table, const Model& source,
                                                   const Wiring& wiring) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < table.columns().size(); ++c)
    if (wiring.uses(c) && parameters_named(source, table.columns()[c]).empty())
      names.push_back(table.columns()[c]);
  return names;
}

/// True if the row has neither pose nor expression.
bool is_lost(const CsvTable& table, std::size_t row, const std::vector<std::size_t>& used) {
  if (const auto state = table.find_column("state"); state && table.cell(row, *state) == "lost") return true;
  return std::all_of(used.begin(), used.end(), [&](std::size_t c) { return table.cell(row, c).empty(); });
}

std::vector<std::size_t> used_columns(const CsvTable& table, const Model& model, const Wiring& wiring,
                                      bool* has_pose) {
  std::vector<std::size_t> used;
  for (const char* name : {"qw", "qx", "qy", "qz", "tx", "ty", "tz"})
    if (const auto column = table.find_column(name)) used.push_back(*column);
  *has_pose = !used.empty();
  for (std::size_t k = 0; k < model.parameters().count; ++k)
    used.insert(used.end(), wiring.columns_of(k).begin(), wiring.columns_of(k).end());
  return used;
}

/// Time of each frame, seconds. glTF requires that those since the first one ascend in single precision.
void set_times(const CsvTable& table, double rate, std::vector<RetargetFrame>* frames) {
  const auto column = table.find_column("time_s");
  for (std::size_t r = 0; r < frames->size(); ++r) {
    const double time = column ? table.precise_number(r, *column) : static_cast<double>(r) / rate;
    const double first = r > 0 ? frames->front().time_s : time,
                 before = r > 0 ? (*frames)[r - 1].time_s : time;
    if (r > 0 && !(static_cast<float>(time - first) > static_cast<float>(before - first)))
      fail_input(table.where(r), "column 'time_s' does not ascend");
    (*frames)[r].time_s = time;
  }
}

/// The identity: the setup's, or that of the last row that has one.
std::vector<float> identity_of(const Model& model, const RetargetSetup& setup,
                               const std::vector<PosedParameters>& rows) {
  std::vector<float> q = rows.back().q;
  if (setup.identity != nullptr) {
    std::fill(q.begin(), q.end(), 0.0f);
    (void)apply(*setup.identity, setup.identity_path, model, q.data());
  }
  for (std::size_t k = 0; k < q.size(); ++k) {
    const Parameter& p = model.parameters()[k];
    q[k] = p.group == Group::identity ? within_range(p, q[k]) : 0;
  }
  return q;
}

}  // namespace

Retargeted retarget(const CsvTable& table, const Model& model, const RetargetSetup& setup) {
  Retargeted out;
  PosedParameters neutral;
  neutral.q.assign(model.parameters().count, 0.0f);
  const auto rows = read_posed_parameters(table, model, neutral, &out.unmatched);
  const Wiring wiring(table, model, &out.unmatched);
  const auto used = used_columns(table, model, wiring, &out.has_pose);
  const auto q = read_columns(table, setup.source, model, wiring);

  for (const Parameter& p : model.parameters())
    out.has_identity = out.has_identity || (p.group == Group::identity && table.find_column(p.name));

  std::size_t known = 0;
  while (known < rows.size() && is_lost(table, known, used)) ++known;
  if (known == rows.size()) {
    std::string why = "has no row with a pose or expression of the model";
    for (const std::string& name : out.unmatched)
      why += (&name == &out.unmatched[0] ? "; it does not have " : ", ") + name;
    fail_input(table.source(), why);
  }
  const std::vector<float> identity = identity_of(model, setup, rows);
  std::vector<std::uint8_t> is_limited(identity.size(), 0);
  std::size_t from = known;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (is_lost(table, r, used))
      ++out.lost;
    else
      from = r;
    RetargetFrame frame{0, {rows[from].pose, identity}};
    for (std::size_t k = 0; k < identity.size(); ++k) {
      if (wiring.columns_of(k).empty()) continue;
      frame.state.q[k] = within_range(model.parameters()[k], q[from][k]);
      if (magnitude(frame.state.q[k] - q[from][k]) > 1e-4f) is_limited[k] = 1;
    }
    out.frames.push_back(std::move(frame));
  }
  set_times(table, setup.rate, &out.frames);
  if (setup.source != nullptr) out.unscaled = columns_without_parameter(table, *setup.source, wiring);
  for (std::uint16_t k = 0; k < identity.size(); ++k) {
    if (!wiring.columns_of(k).empty()) out.driven.push_back(k);
    if (is_limited[k]) out.limited.push_back(model.parameters()[k].name);
  }
  return out;
}

}  // namespace pliant::host
