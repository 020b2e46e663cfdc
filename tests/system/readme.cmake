cmake_minimum_required(VERSION 3.22)
# Extracts the C++ program of README.md, builds it against the installed package with the built-in face and a rendered
# film, runs it and compares the nose with the truth.
# Run as: cmake -DBUILD=... -DSOURCE=... -DCXX=... -DFACE=face.plm [-DLAUNCHER=ccache] -P readme.cmake
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

file(READ ${SOURCE}/README.md readme)
string(FIND "${readme}" "```cpp\n" begin)
if(begin EQUAL -1)
  message(FATAL_ERROR "README.md has no C++ program")
endif()
math(EXPR begin "${begin} + 7")
string(SUBSTRING "${readme}" ${begin} -1 program)
string(FIND "${program}" "```" end)
string(SUBSTRING "${program}" 0 ${end} program)
file(WRITE ${work}/program.cpp "${program}")

set(pliant ${BUILD}/pliant)
run(${pliant} bake ${SOURCE}/fixtures/face -o face.plm --embed face.cpp)
execute_process(COMMAND awk -v frames=60 -f ${SOURCE}/fixtures/frames/motion.awk OUTPUT_FILE ${work}/motion.csv
  COMMAND_ERROR_IS_FATAL ANY)
run(${pliant} render face.plm --params motion.csv --size 320x240 -o film.y4m --truth-points truth.csv)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/system/readme -B ${work}/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_PREFIX_PATH=${work}/prefix -DREADME_PROGRAM=${work}/program.cpp
  -DEMBEDDED_FACE=${work}/face.cpp)
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
