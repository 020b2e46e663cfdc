// Gives the function of docs/porting.md the landmarks of a photograph: those of points.csv, 512 x 512 pixels.
#include <cstdio>
#include <string>
#include <vector>

#include <pliant/pliant.hpp>

extern const unsigned char face[];
extern const std::size_t face_bytes;
pliant::Status fit_picture(const pliant::Model& model, const std::vector<pliant::NamedPoint>& landmarks, int width,
                           int height);

int main(int, char** arguments) {
  std::FILE* const file = std::fopen(arguments[1], "r");
  if (file == nullptr) return 1;
  std::vector<std::string> names;
  std::vector<pliant::NamedPoint> points;
  char name[64];
  float x = 0, y = 0;
  for (char line[256]; std::fgets(line, sizeof line, file) != nullptr;)
    if (std::sscanf(line, "%63[^,],%f,%f", name, &x, &y) == 3) {
      names.emplace_back(name);
      points.push_back({nullptr, {x, y}});
    }
  std::fclose(file);
  for (std::size_t k = 0; k < names.size(); ++k) points[k].name = names[k].c_str();
  pliant::Model model;
  if (pliant::Model::open(face, face_bytes, &model) != pliant::Status::ok) return 1;
  return fit_picture(model, points, 512, 512) == pliant::Status::ok ? 0 : 1;
}
