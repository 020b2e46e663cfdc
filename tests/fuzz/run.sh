#!/bin/sh
# Builds the fuzzers with Clang and runs each for a time, as many at once as there are cores; needs no root, but Clang with
# libFuzzer. Prints the runs of each and their sum.
# usage: sh tests/fuzz/run.sh [--seed N] SECONDS-EACH [NAME]...
#   --seed N   the same inputs in the same order each time, from the corpus of the project alone. Without it what is found is
#              kept in build/fuzz/corpus and goes on from there the next time, for a night
# A finding ends it with 1, and names the file that shows it: build/fuzz/tests/fuzz/NAME_fuzz [--OPTION] FILE repeats it.
set -eu
cd "$(dirname "$0")/../.."

# One fuzzer: run.sh --one SEED SECONDS NAME. An input that takes 60 s or 3 GiB is a finding.
if [ "${1:-}" = --one ]; then
  seed=$2; seconds=$3; name=$4
  case $name in
    mesh | table | print | interface) fuzzer=$name; option= ;;
    *) fuzzer=reader; option=--reader=$name ;;
  esac
  log=build/fuzz/$name.log
  found=build/fuzz/corpus/$name
  [ "$seed" = 0 ] || { found=build/fuzz/seeded/$name; rm -rf "$found"; }
  mkdir -p "$found"
  # shellcheck disable=SC2086
  if ! "build/fuzz/tests/fuzz/${fuzzer}_fuzz" $option "$found" "tests/fuzz/corpus/$name" -seed="$seed" \
      -max_total_time="$seconds" -timeout=60 -rss_limit_mb=3072 -max_len=4096 \
      -artifact_prefix="build/fuzz/$name-" > "$log" 2>&1; then
    grep -E 'ERROR|runtime error|Test unit written' "$log" >&2 || tail -3 "$log" >&2
    echo "fuzz: FAILED: $name, see $log" >&2
    exit 1
  fi
  runs=$(sed -n 's/^#\([0-9]*\).*DONE .*/\1/p' "$log")  # none where reading the corpus took all of the time
  echo "fuzz: $name: ${runs:-0} runs"
  exit 0
fi

seed=0
if [ "${1:-}" = --seed ] && [ $# -ge 2 ]; then seed=$2; shift 2; fi
[ $# -ge 1 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
seconds=$1; shift
[ $# -gt 0 ] || set -- mesh table print interface csv points posed truth json fit calibration y4m pnm picture text-table obj learnt \
  arguments
mkdir -p build/fuzz
printf 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' > build/fuzz/none.cpp
if ! clang++ -fsanitize=fuzzer,address build/fuzz/none.cpp -o build/fuzz/none 2> /dev/null; then
  echo "fuzz: skipped: clang++ is not here, or links no libFuzzer"
  exit 0
fi
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz -- --quiet

printf '%s\n' "$@" | xargs -P "$(nproc)" -n 1 sh tests/fuzz/run.sh --one "$seed" "$seconds" > build/fuzz/runs || status=$?
cat build/fuzz/runs
[ -z "${status:-}" ] || exit 1
awk '{ sum += $3 } END { print "fuzz: " sum " runs, no finding" }' build/fuzz/runs
