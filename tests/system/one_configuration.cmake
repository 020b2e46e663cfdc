cmake_minimum_required(VERSION 3.22)
# One configuration: a program in C++ and one in C, which use nothing but the installed headers and the defaults, track the
# film with the same start as `pliant track`, and print pose, parameters and landmarks of every frame with the same digits.
# PREPARED is the folder with face.plm, frames.y4m and truth_points.csv.
# Run as: cmake -DBUILD=... -DSOURCE=... -DPREPARED=... -DGENERATOR=... -DCXX=... -DCC=... -P one_configuration.cmake
set(work ${BUILD}/one_configuration)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${out}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/system/one_configuration -B ${work}/programs -G ${GENERATOR}
  -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_C_COMPILER=${CC} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${work}/programs)

file(STRINGS ${SOURCE}/tests/system/one_configuration/track.cpp lines)
list(LENGTH lines count)
if(count GREATER 60)
  message(FATAL_ERROR "the program in C++ has ${count} lines: it is to be short enough to be copied")
endif()

# The landmarks of frame 0, which a person or a detector would give.
file(STRINGS ${PREPARED}/truth_points.csv rows REGEX "^0,ibug")
list(TRANSFORM rows REPLACE "^0," "")
list(JOIN rows "\n" rows)
file(WRITE ${work}/points.csv "landmark,x,y\n${rows}\n")

# rows_of(FILE VARIABLE COLUMNS): the rows of a table without its first columns.
function(rows_of file variable columns)
  file(STRINGS ${file} rows)
  if(columns GREATER 0)
    list(POP_FRONT rows)  # the header
    string(REPEAT "[^,]*," ${columns} front)
    list(TRANSFORM rows REPLACE "^${front}(.*)$" ",\\1")
  endif()
  set(${variable} "${rows}" PARENT_SCOPE)
endfunction()

# compare(PROGRAM PROFILE arguments...): a program's output with the command's table of that profile; without one, of none.
function(compare program profile)
  set(option "")
  if(profile)
    set(option --profile ${profile})
  endif()
  run(${work}/prefix/bin/pliant track ${PREPARED}/face.plm --frames ${PREPARED}/frames.y4m --init ${work}/points.csv
    --landmarks ${option} --out ${work}/track.csv)
  execute_process(COMMAND ${work}/programs/${program} ${PREPARED}/face.plm ${work}/points.csv ${PREPARED}/frames.y4m ${ARGN}
    OUTPUT_FILE ${work}/${program}.csv COMMAND_ERROR_IS_FATAL ANY)
  rows_of(${work}/track.csv expected 10)
  rows_of(${work}/${program}.csv printed 0)
  list(LENGTH printed count)
  if(count LESS 20)
    message(FATAL_ERROR "${program} printed ${count} frames")
  endif()
  if(NOT printed STREQUAL expected)
    message(FATAL_ERROR "${program} ${ARGN} and pliant track differ: ${work}/${program}.csv, ${work}/track.csv")
  endif()
  message(STATUS "${program} ${ARGN}: ${count} frames with the digits of pliant track")
endfunction()
compare(track_cpp "")
compare(track_c "" M)
compare(track_c s S)
