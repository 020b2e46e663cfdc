#include "host/commands/render_grid.hpp"

#include <algorithm>

#include "host/io/failure.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/track_table.hpp"
#include "host/render/draw.hpp"
#include "host/render/scene.hpp"

namespace pliant::host {

namespace {

constexpr int kGap = 2, kTextSpace = 5, kOversampling = 3;
/// Of names; capitals are 10 px high.
constexpr float kTextScale = 1.4f;
constexpr int kNameHeight = static_cast<int>(kTextHeight * kTextScale);
constexpr std::size_t kMostPictures = 64;
constexpr std::uint8_t kPaper = 236;
/// Height of the mean face as a fraction of a cell's; all faces have its scale. Leaves room for the widest.
constexpr float kFilledCell = 0.72f;

struct NamedRows {
  std::vector<std::string> names;
  std::vector<PosedParameters> rows;
  std::vector<float> tones;
};

/// Brightness of the surface in a row; 1 without such a column or a value in it.
float tone_in(const CsvTable& table, std::size_t row) {
  const auto column = table.find_column("tone");
  return column && !table.cell(row, *column).empty() ? clamp(table.number(row, *column), 0, 2) : 1;
}

NamedRows read_rows(const std::string& path, const Model& model, const PosedParameters& neutral,
                    bool has_tone, Console& console) {
  const CsvTable table(path, read_file(path));
  const std::size_t name = table.column("name");
  NamedRows out;
  std::vector<std::string> unmatched;
  out.rows = read_posed_parameters(table, model, neutral, &unmatched, EmptyCell::neutral);
  const auto is_ours = [&](const std::string& c) { return c == "name" || (has_tone && c == "tone"); };
  unmatched.erase(std::remove_if(unmatched.begin(), unmatched.end(), is_ours), unmatched.end());
  list_unmatched(unmatched, path, console.err);
  list_clamped(clamp_to_limits(model, out.rows), path, console.err);
  if (out.rows.empty()) fail_input(path, "has no rows");
  if (out.rows.size() > kMostPictures) fail_input(path, "has more than 64 rows");
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    out.names.push_back(table.cell(r, name));
    out.tones.push_back(has_tone ? tone_in(table, r) : 1);
  }
  return out;
}

/// The identity of `person` with the expression of `expression`.
std::vector<float> combined(const Model& model, const PosedParameters& person,
                            const PosedParameters& expression) {
  std::vector<float> q;
  for (std::size_t k = 0; k < model.parameters().count; ++k)
    q.push_back(model.parameters()[k].group == Group::identity ? person.q[k] : expression.q[k]);
  return q;
}

}  // namespace

Image draw_grid(const ModelFile& file, const std::string& people, const std::string& expressions,
                ImageSize cell, Console& console) {
  const Model& model = file.model();
  const Camera camera = centred_camera(cell.width, cell.height, 3.0f * static_cast<float>(cell.height));
  PosedParameters neutral;
  neutral.q.assign(model.parameters().count, 0.0f);
  neutral.pose = frontal_pose(model, neutral.q.data(), camera, cell.height, kFilledCell);
  const NamedRows persons = read_rows(people, model, neutral, true, console),
                  moods = read_rows(expressions, model, neutral, false, console);

  int margin = 0;
  for (const std::string& name : moods.names)
    margin = std::max(margin, text_width(name, kTextScale) + 2 * kTextSpace);
  const int head = kNameHeight + 2 * kTextSpace, step_x = cell.width + kGap, step_y = cell.height + kGap;
  Image grid(margin + static_cast<int>(persons.rows.size()) * step_x,
             head + static_cast<int>(moods.rows.size()) * step_y, 1, kPaper);
  const Image paper(cell.width, cell.height, 1, kPaper);
  Scene scene(model, cell.width, cell.height, 224, kOversampling);
  Progress progress(console, "picture", persons.rows.size() * moods.rows.size());
  for (std::size_t c = 0; c < persons.rows.size(); ++c) {
    const int x = margin + static_cast<int>(c) * step_x;
    const std::string& name = persons.names[c];
    draw_text(grid, x + (cell.width - text_width(name, kTextScale)) / 2, kTextSpace, name,
              {kTextScale, {}, 1});
    for (std::size_t r = 0; r < moods.rows.size(); ++r) {
      const int y = head + static_cast<int>(r) * step_y;
      if (c == 0)
        draw_text(grid, kTextSpace, y + (cell.height - kNameHeight) / 2, moods.names[r], {kTextScale, {}, 1});
      const auto q = combined(model, persons.rows[c], moods.rows[r]);
      paste(grid, scene.draw(q.data(), moods.rows[r].pose, camera, paper, persons.tones[c]), x, y);
      progress.show(c * moods.rows.size() + r + 1);
    }
  }
  return grid;
}

}  // namespace pliant::host
