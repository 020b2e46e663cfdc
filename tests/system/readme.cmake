cmake_minimum_required(VERSION 3.22)
# Extracts the C++ program of README.md, builds it against the installed package with the built-in face and a rendered
# film, runs it and compares the nose with the truth; and the function of docs/porting.md, with the landmarks of a
# photograph; and builds its program for libcamera, where that is installed; and compiles its calls in C.
# Run as: cmake -DBUILD=... -DSOURCE=... -DCXX=... -DCC=... [-DLAUNCHER=ccache] -P readme.cmake
set(work ${BUILD}/readme)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${work} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

# extract(DOCUMENT LANGUAGE FILE [HEADING]): the first program of a document, or below a heading, in that language. Sets `program`.
function(extract document language file)
  file(READ ${SOURCE}/${document} text)
  if(ARGN)
    string(FIND "${text}" "\n${ARGN}\n" heading)
    if(heading EQUAL -1)
      message(FATAL_ERROR "${document} has no heading ${ARGN}")
    endif()
    string(SUBSTRING "${text}" ${heading} -1 text)
  endif()
  string(FIND "${text}" "```${language}\n" begin)
  if(begin EQUAL -1)
    message(FATAL_ERROR "${document} has no program in ${language}")
  endif()
  string(LENGTH "```${language}\n" fence)
  math(EXPR begin "${begin} + ${fence}")
  string(SUBSTRING "${text}" ${begin} -1 program)
  string(FIND "${program}" "```" end)
  string(SUBSTRING "${program}" 0 ${end} program)
  file(WRITE ${work}/${file} "${program}")
  set(program "${program}" PARENT_SCOPE)
endfunction()
extract(README.md cpp program.cpp)
extract(docs/porting.md cpp fit_picture.cpp)
extract(docs/porting.md cpp camera_program.cpp "### libcamera")
extract(docs/porting.md c calls.c)
# The calls in C are a part of a function.
file(WRITE ${work}/calls.c "#include <pliant/pliant.h>
void calls(void *memory, const void *table, size_t table_bytes, pliant_frame frame);
void calls(void *memory, const void *table, size_t table_bytes, pliant_frame frame) {\n${program}}\n")
run(${CC} -std=c99 -Wall -Wextra -Wconversion -pedantic -Werror -I${SOURCE}/include -c calls.c)

set(pliant ${BUILD}/pliant)
# As for firmware: an array of a third of the size, which takes a third of the time to compile.
run(${pliant} bake ${SOURCE}/fixtures/face -o face.plm --embed face.cpp --bits 8 --size 64)
execute_process(COMMAND awk -v frames=60 -f ${SOURCE}/fixtures/frames/motion.awk OUTPUT_FILE ${work}/motion.csv
  COMMAND_ERROR_IS_FATAL ANY)
run(${pliant} render face.plm --params motion.csv --size 320x240 -o film.y4m --truth-points truth.csv)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/system/readme -B ${work}/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_PREFIX_PATH=${work}/prefix -DREADME_PROGRAM=${work}/program.cpp
  -DPICTURE_FUNCTION=${work}/fit_picture.cpp -DCAMERA_PROGRAM=${work}/camera_program.cpp -DEMBEDDED_FACE=${work}/face.cpp)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/readme)
file(WRITE ${work}/printed.txt "${out}")

# Every frame has a line, and the nose is never more than 2 px off. Measured: 0.9 px at most.
execute_process(COMMAND awk -F "[ ,]+" [[
  FNR == NR { if ($2 == "nose_tip") { x[$1] = $3; y[$1] = $4 } next }
  { k = FNR - 1; d = sqrt((x[k] - $5) ^ 2 + (y[k] - $6) ^ 2); if (d > most) most = d; n = FNR }
  END { printf "%d frames, nose off by at most %.1f px\n", n, most; exit !(n == 60 && most < 2) }]]
  truth.csv printed.txt WORKING_DIRECTORY ${work} RESULT_VARIABLE result OUTPUT_VARIABLE out)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${out}")
endif()
message(STATUS "${out}")

# The tip of the photograph's nose is near where it is annotated, at 223.8 127.3.
run(${work}/build/picture ${SOURCE}/fixtures/astronaut/points.csv)
message(STATUS "${out}")
if(NOT out MATCHES "^nose at 22[1-6]\\.[0-9] 12[4-9]\\.[0-9], face [0-9]+ mm away, residuals [0-2]\\.")
  message(FATAL_ERROR "docs/porting.md: the fit of a picture is off")
endif()
