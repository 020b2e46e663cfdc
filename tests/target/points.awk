# The iBUG landmarks of frame 0 (of the truth of `pliant render`) as a C header.
# usage: awk -F, -f points.awk truth_points.csv
BEGIN { print "#include \"pliant/pliant.h\"\n\nstatic const pliant_point points[] = {" }
$1 == "0" && $2 ~ /^ibug/ { printf "    {\"%s\", %sf, %sf},\n", $2, $3, $4 }
END { print "};" }
