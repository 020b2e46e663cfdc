#!/bin/sh
# Runs the commands of docs/your-own-surface.md as they stand there: the five of the first block, those of the start by hand,
# for which the points that a person would save are made from the truth, and those of a face in OBJ files, which are made of the
# built-in face. Checks the tracks.
# usage: sh tests/system/own_surface.sh SOURCE_FOLDER PLIANT FACE_PLM
set -eu
LC_ALL=C; export LC_ALL
source=$1 pliant=$2 face=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$pliant" "$work/bin/pliant"
ln -s "$source/fixtures" "$work/fixtures"
PATH=$work/bin:$PATH; export PATH
# block N: the lines of the page's Nth indented block.
block() {
  awk -v wanted="$1" '/^    / { if (!inside) ++count; inside = 1; if (count == wanted) print substr($0, 5); next }
    { inside = 0 }' "$source/docs/your-own-surface.md"
}
block 1 > "$work/commands"
[ "$(wc -l < "$work/commands")" -eq 5 ] || { echo "the page does not have five commands"; exit 1; }
cd "$work"
sh -eu commands > printed || { cat printed; exit 1; }
tail -1 printed
[ "$(wc -l < track.csv)" -eq 201 ] || { echo "track.csv does not have a row a frame"; exit 1; }
# The sheet is beyond the picture in about 20 frames. Measured: 0.6 degrees.
check() {
  tail -1 "$1" | awk '{
    for (i = 1; i <= NF; ++i) { split($i, pair, "="); v[pair[1]] = pair[2] }
    exit !(v["frames"] == 200 && v["tracked"] >= 160 && v["rotation_deg"] < 1) }' || { echo "the track is not right"; exit 1; }
}
check printed

# The memory that the page on porting states for this surface.
bytes=$(pliant plan sheet.plm --profile s | awk '$1 == "arena" { print $2 }' | sed 's/...$/,&/')
grep -q "profile S takes $bytes bytes" "$source/docs/porting.md" || {
  echo "docs/porting.md does not say that profile S takes $bytes bytes"; exit 1; }

# What the page states of searches.
page=$source/docs/your-own-surface.md
states() {
  grep -qF "$1" "$page" || { echo "docs/your-own-surface.md does not say: $1"; exit 1; }
}
frames_of_search() { pliant plan sheet.plm --profile "$1" | awk '/frames of a search, at most/ { print $NF }'; }
states "at most $(frames_of_search m) with profiles M and L, and $(frames_of_search s) with profile S"
[ "$(frames_of_search m)" = "$(frames_of_search l)" ] || { echo "profiles M and L differ"; exit 1; }
seconds() {
  pliant plan sheet.plm --profile s --mhz 480 | awk -v what="$1" 'index($0, what) == 3 {
    printf "usually %.1f s and at most %.1f s", $(NF - 1) / 1000, $NF / 1000 }'
}
states "takes $(seconds 'a frame without '), and the frame of the start $(seconds 'a frame that starts a track ')"
first_tracked() {
  pliant track sheet.plm --frames film.y4m --profile "$1" --count 40 --out first.csv > first.txt
  awk -F, '$3 == "tracking" { print $1; exit }' first.csv
}
states "frame $(first_tracked m) with profiles M and L, and frame $(first_tracked s) with profile S;"

# The start by hand. The truth of frame 0 as a fit, whose handles are on the page; all nine are placed there, to the pixel.
block 2 > commands
[ "$(wc -l < commands)" -eq 2 ] || { echo "the start by hand does not have two commands"; exit 1; }
pliant fit sheet.plm --size 640x480 --box 200,100,200,280 -o box.json
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) name[i] = $i; next } NR == 2 { for (i = 1; i <= NF; ++i) print name[i], $i }' motion.csv > state
awk 'NR == FNR { v[$1] = $2; next }
  /"pose"/ { print "  \"pose\": {\"q\": [" v["qw"] ", " v["qx"] ", " v["qy"] ", " v["qz"] "], \"t\": [" v["tx"] ", " v["ty"] ", " v["tz"] "]},"; next }
  /"parameters"/ { print "  \"parameters\": {\"mode00\": " v["mode00"] ", \"mode01\": " v["mode01"] ", \"mode02\": " v["mode02"] ", \"mode03\": " v["mode03"] "},"; next }
  { print }' state box.json > true.json
pliant points sheet.plm --frames film.y4m --start true.json -o true.html
{
  echo landmark,x,y,u,v,placed
  grep -o '"name":"uv_[^{}]*"placed"' true.html | awk -F'[:,]' '{
    printf "%s,%.0f,%.0f,%s,%s,1\n", substr($2, 2, length($2) - 2), $8, $10, $4, $6 }'
} > points.csv
[ "$(wc -l < points.csv)" -eq 10 ] || { echo "the page does not have nine handles"; exit 1; }
sh -eu commands > printed || { cat printed; exit 1; }
tail -1 printed
check printed

# A face in OBJ files: some of the built-in face's shapes, and for each landmark the vertex that is seen nearest to it.
cp "$face" face.plm
mkdir my_face
shape() {
  file=$1; shift
  pliant mesh face.plm --criterion uniform --depth 4 "$@" -o "my_face/$file.obj" > printed || { cat printed; exit 1; }
}
shape neutral
for name in jawOpen mouthSmileLeft mouthSmileRight eyeBlinkLeft eyeBlinkRight; do shape "$name" --param "$name=0.4"; done
for name in faceWidth lowerFaceHeight noseLength eyeSpacing; do shape "identity_$name" --param "$name=1"; done
echo qw,qx,qy,qz,tx,ty,tz > frontal.csv
echo 1,0,0,0,0,0,1000 >> frontal.csv
pliant render face.plm --params frontal.csv --size 640x640 --focal 2000 -o frontal.y4m --truth-points frontal_points.csv > printed
awk -F'[ ,]' 'BEGIN { print "landmark,vertex" }
  FNR == NR { if ($1 == "v") { s = 2000 / (1000 - $4); x[n] = 319.5 + s * $2; y[n++] = 319.5 - s * $3 } next }
  FNR > 1 { least = 1e9
    for (i = 0; i < n; ++i) { d = (x[i] - $3) ^ 2 + (y[i] - $4) ^ 2; if (d < least) { least = d; nearest = i } }
    print $2 "," nearest }' my_face/neutral.obj frontal_points.csv > my_face/landmarks.csv
cp fixtures/face/learnt.bin my_face
awk -v frames=60 -f "$source/fixtures/frames/motion.awk" > motion.csv
pliant render face.plm --params motion.csv -o clip.y4m > printed
block 3 > commands
[ "$(wc -l < commands)" -eq 3 ] || { echo "the face does not have three commands"; exit 1; }
sh -eu commands > printed || { cat printed; exit 1; }
tracked=$(awk -F, '$3 == "tracking"' track.csv | wc -l)
echo "a face in OBJ files: $tracked of 60 frames tracked"
[ "$tracked" -ge 55 ] || exit 1
