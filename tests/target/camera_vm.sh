#!/bin/sh
# `pliant track --frames camera:` on a camera that is really there: the distribution's kernel and libcamera in a virtual
# machine, with a USB camera that plays a video (usb_camera.py). Tracks a rendered sequence, and the Talking Face where
# PLIANT_DATA names the folder that holds it, and compares each with the track of the file; opens the camera again in one
# process; then pulls the plug in mid-run, with udev in the guest and without. No hardware and no /dev/kvm; about two minutes.
# Says so and passes where the machine cannot be made: no x86-64, no QEMU, no kernel package.
# usage: sh tests/target/camera_vm.sh PATH-OF-pliant WORK-FOLDER
set -eu
LC_ALL=C; export LC_ALL
here=$(cd "$(dirname "$0")" && pwd)
pliant=$(realpath "$1")
mkdir -p "$2"; work=$(realpath "$2")
skip() { echo "camera_vm: skipped: $1"; exit 0; }
fail() { echo "camera_vm: FAILED: $1" >&2; exit 1; }

[ "$(uname -m)" = x86_64 ] || skip "the guest is an x86-64 one, this machine is not"
if "$pliant" camera list 2>&1 | grep -q 'without libcamera'; then skip "pliant was built without libcamera"; fi
for tool in qemu-system-x86_64 busybox cpio modprobe depmod python3 apt-get dpkg-deb; do
  command -v "$tool" >/dev/null 2>&1 || [ -x "/sbin/$tool" ] || skip "there is no $tool"
done
PATH=$PATH:/sbin; export PATH

# The kernel and udev, unpacked beside the work and not installed.
parts=$work/parts
if [ ! -e "$parts/complete" ]; then
  image=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image-/ { print $2; exit }')
  [ -n "$image" ] || skip "there is no kernel package linux-image-amd64 to be had"
  rm -rf "$parts"; mkdir -p "$parts"
  (cd "$parts" && apt-get -q download "$image" udev >download.log 2>&1) || skip "the kernel cannot be downloaded"
  for package in "$parts"/*.deb; do dpkg-deb -x "$package" "$parts"; rm "$package"; done
  depmod -b "$parts" "$(ls "$parts/lib/modules")"
  touch "$parts/complete"
fi
kernel=$(ls "$parts/lib/modules")

# A program and the shared libraries that it needs, into the guest.
put_program() {
  mkdir -p "$root$(dirname "$2")"; cp "$1" "$root$2"
  ldd "$1" 2>/dev/null | awk '{ for (i = 1; i <= NF; ++i) if ($i ~ /^\//) print $i }' | while read -r library; do
    mkdir -p "$root$(dirname "$library")"; cp -L "$library" "$root$library"
  done
}

# boot NAME VIDEO RATE UNPLUG-AFTER UDEV: runs $work/NAME.sh in the guest; what it prints goes to $work/NAME.log, what
# it leaves as /tmp/out to $work/NAME.out.
boot() {
  root=$work/root
  rm -rf "$root"; mkdir -p "$root/bin" "$root/dev" "$root/proc" "$root/sys" "$root/run" "$root/tmp" "$root/modules"
  cp "$(command -v busybox)" "$root/bin/busybox"
  for name in sh mount insmod sleep cat base64 poweroff; do ln -s busybox "$root/bin/$name"; done
  put_program "$pliant" /bin/pliant
  put_program "$(dirname "$pliant")/pliant-camera.so" /bin/pliant-camera.so
  put_program "$(dirname "$pliant")/tests/camera_reopen" /bin/camera_reopen
  put_program "$parts/bin/udevadm" /bin/udevadm
  cp "$root/bin/udevadm" "$root/bin/systemd-udevd"
  for module in xhci_pci uvcvideo; do modprobe -d "$parts" -S "$kernel" --show-depends "$module"; done |
    awk '$1 == "insmod" && !seen[$2]++ { print $2 }' > "$work/modules.txt"
  while read -r module; do cp "$module" "$root/modules/"; basename "$module" >> "$root/modules/order"; done < "$work/modules.txt"
  cp "$work/face.plm" "$work/$1.points.csv" "$root/"
  cp "$work/$1.sh" "$root/test.sh"
  cat > "$root/init" <<INIT
#!/bin/sh
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev; mount -t tmpfs tmp /tmp; mount -t tmpfs run /run
/bin/systemd-udevd --daemon
while read module; do insmod /modules/\$module; done < /modules/order
for second in 1 2 3 4 5 6 7 8 9 10; do [ -e /dev/video0 ] || sleep 1; done
udevadm trigger; udevadm settle
[ $5 = yes ] || udevadm control --exit  # the camera is known, and nobody will tell when it goes
sleep 1
sh /test.sh > /tmp/said 2>&1; cat /tmp/said  # no terminal, no progress lines
echo "guest: begin"; [ ! -e /tmp/out ] || base64 /tmp/out; echo "guest: end"
poweroff -f
INIT
  chmod +x "$root/init"
  (cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) > "$work/initrd.gz"
  rm -f "$work/usb"
  python3 "$here/usb_camera.py" "$work/usb" "$2" "$3" "$4" & camera=$!
  for tenth in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do [ -S "$work/usb" ] || sleep 0.5; done
  timeout 180 qemu-system-x86_64 -accel tcg -cpu max -M q35 -m 1024 -smp 2 -display none -no-reboot -nodefaults \
    -serial stdio -device qemu-xhci,id=bus -chardev "socket,id=plug,path=$work/usb" \
    -device usb-redir,chardev=plug,bus=bus.0 -kernel "$parts/boot/vmlinuz-$kernel" -initrd "$work/initrd.gz" \
    -append "console=ttyS0 quiet loglevel=0 panic=-1" < /dev/null 2>&1 | tr -d '\r' > "$work/$1.log" || true
  kill "$camera" 2>/dev/null || true
  wait "$camera" 2>/dev/null || true
  awk '/^guest: end/ { inside = 0 } inside { print } /^guest: begin/ { inside = 1 }' "$work/$1.log" | base64 -d > "$work/$1.out"
  grep -q '^guest: end' "$work/$1.log" || { tail -20 "$work/$1.log" >&2; fail "$1: the guest did not come to its end"; }
}

# compare FILE.csv CAMERA.csv: mean distance of all landmarks, frame by frame. The camera starts some frames late and keeps
# its own numbers, so the shift that agrees best is taken.
compare() {
  awk -F, '
    FNR == 1 { n = 0; for (i = 1; i <= NF; ++i) if ($i ~ /^x_/) at[n++] = i; next }
    NR == FNR { for (k = 0; k < n; ++k) { x[$1, k] = $at[k]; y[$1, k] = $(at[k] + 1) } ; last = $1; next }
    $3 == "tracking" { ++rows; frame[rows] = $1; for (k = 0; k < n; ++k) { u[rows, k] = $at[k]; v[rows, k] = $(at[k] + 1) } }
    END {
      best = -1
      for (late = 0; late <= 6; ++late) {
        sum = count = 0
        for (r = 1; r <= rows; ++r) for (k = 0; k < n; ++k) {
          f = frame[r] + late
          if (!((f, k) in x)) continue
          sum += sqrt((x[f, k] - u[r, k]) ^ 2 + (y[f, k] - v[r, k]) ^ 2); ++count
        }
        if (count > 0 && (best < 0 || sum / count < best)) { best = sum / count; at_late = late }
      }
      printf "%d %d %.4f\n", rows, at_late, best
    }' "$1" "$2"
}

# track_both NAME VIDEO SIZE RATE COUNT MOST-PX: the video as a file here and as a camera there.
track_both() {
  "$pliant" track "$work/face.plm" --frames "$2" --init "$work/$1.points.csv" --out "$work/$1.file.csv" --landmarks > /dev/null
  cat > "$work/$1.sh" <<TEST
pliant camera list
pliant track /face.plm --frames camera:@$3 --init /$1.points.csv --count 5 --out /tmp/out
echo "guest: first exit \$?"
pliant track /face.plm --frames camera:@$3 --init /$1.points.csv --count $5 --out /tmp/out --landmarks
echo "guest: second exit \$?"
TEST
  boot "$1" "$2" "$4" -1 yes
  grep -q 'Camera without hardware' "$work/$1.log" || fail "$1: the camera is not listed"
  grep -q 'first exit 0' "$work/$1.log" || fail "$1: $(grep -a '^pliant' "$work/$1.log" | tail -1)"
  grep -q 'second exit 0' "$work/$1.log" || fail "$1: $(grep -a '^pliant' "$work/$1.log" | tail -1)"
  read -r rows late px <<NUMBERS
$(compare "$work/$1.file.csv" "$work/$1.out")
NUMBERS
  echo "camera_vm: $1: $rows of $5 frames tracked, $late lost at the start, landmarks $px px from the file's"
  awk "BEGIN { exit !($rows >= 0.8 * $5 && $px >= 0 && $px < $6) }" || fail "$1: not as the file"
}

# reopen NAME VIDEO: a camera that is opened again in one process gives each frame once, and nothing of its first opening.
reopen() {
  cat > "$work/$1.sh" <<TEST
MALLOC_PERTURB_=85 camera_reopen
echo "guest: exit \$?"
TEST
  cp "$work/rendered.points.csv" "$work/$1.points.csv"
  boot "$1" "$2" 4 -1 yes
  grep -q 'guest: exit 0' "$work/$1.log" || fail "$1: $(grep -a 'opening\|guest: exit' "$work/$1.log" | tr '\n' ' ')"
  echo "camera_vm: $1: $(grep -a 'openings' "$work/$1.log")"
}

# unplug NAME VIDEO WITH-UDEV: the run ends by itself, with one clear line, exit 1, and the frames before it.
unplug() {
  cat > "$work/$1.sh" <<TEST
pliant track /face.plm --frames camera:@320x240 --init /$1.points.csv --out /tmp/out
echo "guest: exit \$?"
TEST
  cp "$work/rendered.points.csv" "$work/$1.points.csv"
  boot "$1" "$2" 4 16 "$3"
  grep -q 'guest: exit 1' "$work/$1.log" || fail "$1: $(grep -a 'guest: exit' "$work/$1.log")"
  line=$(grep -a '^pliant track: camera: the camera' "$work/$1.log") || fail "$1: no line says that the camera is gone"
  rows=$(awk -F, '$3 == "tracking"' "$work/$1.out" | wc -l)
  echo "camera_vm: $1: $rows frames, then: ${line#pliant track: }"
  [ "$rows" -ge 6 ] || fail "$1: too few frames"
}

fixtures=$here/../../fixtures
"$pliant" bake "$fixtures/face" -o "$work/face.plm" > /dev/null
# The first picture is held for a while: a camera may lose its first frames.
awk -v frames=60 -f "$fixtures/frames/motion.awk" | awk 'NR == 2 { for (i = 0; i < 6; ++i) print } { print }' > "$work/motion.csv"
"$pliant" render "$work/face.plm" --params "$work/motion.csv" --size 320x240 -o "$work/rendered.y4m" \
  --truth-points "$work/truth.csv" > /dev/null
awk -F, 'NR == 1 { print "landmark,x,y" } $1 == "0" && $2 ~ /^ibug/ { print $2 "," $3 "," $4 }' "$work/truth.csv" \
  > "$work/rendered.points.csv"
track_both rendered "$work/rendered.y4m" 320x240 4 50 0.5
reopen reopened "$work/rendered.y4m"
unplug unplugged "$work/rendered.y4m" yes
unplug unplugged_without_udev "$work/rendered.y4m" no

face=${PLIANT_DATA:-}/franck
if [ -e "$face/franck.mp4" ] && command -v ffmpeg > /dev/null; then
  ffmpeg -v error -y -i "$face/franck.mp4" -frames:v 60 -vf tpad=start=6:start_mode=clone -f yuv4mpegpipe -pix_fmt gray \
    "$work/talking.y4m"
  awk -F, 'NR == FNR { if ($1 ~ /^[0-9]+$/) ibug[$1] = $2; next } FNR == 2 {
    print "landmark,x,y"; for (i = 0; i < 68; ++i) if (i in ibug) printf "ibug%02d,%s,%s\n", ibug[i], $(2 + 2 * i), $(3 + 2 * i) }' \
    "$face/fgnet68_to_ict.csv" "$face/points_mp4.csv" > "$work/talking.points.csv"
  size=$(head -1 "$work/talking.y4m" | awk '{ for (i = 2; i <= NF; ++i) { if ($i ~ /^W/) w = substr($i, 2); if ($i ~ /^H/) h = substr($i, 2) } print w "x" h }')
  track_both talking "$work/talking.y4m" "$size" 4 50 0.5
else
  echo "camera_vm: the Talking Face is not there (PLIANT_DATA): not tracked"
fi
