#include "cli_run.hpp"

#include <algorithm>
#include <sstream>

namespace cli_run {

Ran run_words(const std::vector<std::string>& words) {
  std::ostringstream out, err;
  Console console{out, err};
  const int code = run(words, console);
  return {code, out.str(), err.str()};
}

bool is_one_line(const std::string& text) {
  return !text.empty() && text.back() == '\n' && std::count(text.begin(), text.end(), '\n') == 1;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void check_refused(const std::vector<std::string>& words, const std::vector<std::string>& parts) {
  const Ran r = run_words(words);
  CAPTURE(r.err);
  CHECK(r.code == 1);
  CHECK(is_one_line(r.err));
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(contains(r.err, part));
  }
}

std::string model_bytes() {
  const auto bytes = TexturedModel{}.bytes();
  return {bytes.begin(), bytes.end()};
}

Sequence::Sequence() {
  model = put("m.plm", model_bytes());
  std::string params = "frame,qw,qx,qy,qz,tx,ty,tz,width,browUpLeft,jawOpen\n";
  for (int k = 0; k < 12; ++k) {
    const auto t = static_cast<float>(k) / 11;
    const Quat q = exp_rotation({0.05f * t, 0.25f * t, -0.1f * t});
    std::ostringstream row;
    row << k << "," << q.w << "," << q.x << "," << q.y << "," << q.z << "," << 20 * t << "," << -5 * t
        << ",420,0.8," << 0.5f * t << "," << 0.1f * static_cast<float>(k % 6) << "\n";
    params += row.str();
  }
  put("q.csv", params);
  video = *this / "v.y4m";
  truth = *this / "truth.csv";
  const Ran r = run_words({"render", model, "--params", *this / "q.csv", "-o", video, "--truth", truth,
                           "--truth-points", *this / "tp.csv", "--size", "200x160", "--focal", "330"});
  REQUIRE(r.err == "");
  REQUIRE(r.code == 0);
  points = put("p.csv", first_points());
}

std::string Sequence::first_points() const {
  std::istringstream in(read_file(*this / "tp.csv"));
  std::string line, out = "landmark,x,y\n";
  while (std::getline(in, line))
    if (line.rfind("0,", 0) == 0) out += line.substr(2) + "\n";
  return out;
}

std::vector<std::string> Sequence::track_words() const {
  return {"track", model, "--frames", video, "--init", points, "--out", *this / "t.csv", "--focal", "330"};
}

float value_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key + "=");
  REQUIRE(at != std::string::npos);
  return std::stof(text.substr(at + key.size() + 1));
}

Sequence::~Sequence() = default;

}  // namespace cli_run
