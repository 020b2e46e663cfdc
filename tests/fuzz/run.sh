#!/bin/sh
# Builds the fuzzers with Clang and runs each for a time; needs no root, but Clang with libFuzzer. Prints the runs of each and
# their sum. What it finds in a night is kept in build/fuzz/corpus and goes on from there the next time.
# usage: sh tests/fuzz/run.sh SECONDS-EACH [NAME]...
# A finding ends it with 1, and names the file that shows it: build/fuzz/tests/fuzz/NAME_fuzz [--OPTION] FILE repeats it.
set -eu
cd "$(dirname "$0")/../.."
[ $# -ge 1 ] || { sed -n 's/^# usage: /usage: /p' "$0" >&2; exit 2; }
seconds=$1; shift
readers="csv points posed truth json fit calibration y4m pnm picture text-table obj learnt arguments"
[ $# -gt 0 ] || set -- mesh table interface $readers
mkdir -p build/fuzz
printf 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' > build/fuzz/none.cpp
if ! clang++ -fsanitize=fuzzer,address build/fuzz/none.cpp -o build/fuzz/none 2> /dev/null; then
  echo "fuzz: skipped: clang++ is not here, or links no libFuzzer"
  exit 0
fi
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz -- --quiet

sum=0
for name in "$@"; do
  fuzzer=$name; option=
  case " $readers " in *" $name "*) fuzzer=reader; option=--reader=$name ;; esac
  found=build/fuzz/corpus/$name
  mkdir -p "$found"
  # A start longer than the time counts as a run of no inputs; an input that takes 60 s or 3 GiB is a finding.
  # shellcheck disable=SC2086
  if ! "build/fuzz/tests/fuzz/${fuzzer}_fuzz" $option "$found" "tests/fuzz/corpus/$name" -max_total_time="$seconds" \
      -timeout=60 -rss_limit_mb=3072 -max_len=4096 -artifact_prefix="build/fuzz/$name-" > "build/fuzz/$name.log" 2>&1; then
    grep -E 'ERROR|runtime error|Test unit written' "build/fuzz/$name.log" >&2
    echo "fuzz: FAILED: $name, see build/fuzz/$name.log" >&2
    exit 1
  fi
  runs=$(sed -n 's/^#\([0-9]*\).*DONE .*/\1/p' "build/fuzz/$name.log")
  sum=$((sum + ${runs:-0}))
  echo "fuzz: $name: ${runs:-0} runs"
done
echo "fuzz: $sum runs, no finding"
