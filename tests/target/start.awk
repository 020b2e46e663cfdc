# The first row of a track (or of the truth of `pliant render`) as a C++ header: where the firmware starts.
# usage: awk -F, -v f=PX -v width=W -v height=H -f start.awk track.csv
function literal(x) { return (x ~ /[.e]/ ? x : x ".0") "f" }
function value(name) { return literal($column[name]) }
NR == 1 {
  for (i = 1; i <= NF; ++i) {
    column[$i] = i
    if ($i ~ /^x_/ && !end) end = i  # landmarks come behind the parameters
  }
  if (!end) end = NF + 1
}
NR == 2 {
  print "#pragma once\n// Where the face is in the first frame.\n#include \"pliant/camera.hpp\"\n"
  printf "constexpr pliant::Camera kStartCamera = pliant::centred_camera(%d, %d, %s);\n", width, height, literal(f)
  printf "constexpr pliant::Pose kStartPose{{%s, %s, %s, %s},\n", value("qw"), value("qx"), value("qy"), value("qz")
  printf "                                 {%s, %s, %s}};\n", value("tx"), value("ty"), value("tz")
  printf "constexpr float kStartParameters[] = {"
  for (i = column["tz"] + 1; i < end; ++i) printf "%s, ", literal($i)
  print "};"
  exit
}
