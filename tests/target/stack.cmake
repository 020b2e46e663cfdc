cmake_minimum_required(VERSION 3.22)
# No function of the portable libraries has a stack frame above LIMIT bytes, by the compiler's own account
# (PLIANT_CALL_GRAPH). Run as: cmake -DBUILD=build/folder -DLIMIT=bytes -P stack.cmake
file(GLOB_RECURSE graphs ${BUILD}/src/CMakeFiles/pliant_core.dir/*.ci
  ${BUILD}/platform/CMakeFiles/pliant_track.dir/*.ci)
list(LENGTH graphs count)
if(count LESS 50)
  message(FATAL_ERROR "${count} call graphs in ${BUILD}: a compiler cache does not keep them, build without one")
endif()
execute_process(COMMAND awk -v limit=${LIMIT} -v "roots=Tracker5start Tracker6update"
  -f ${CMAKE_CURRENT_LIST_DIR}/stack.awk ${graphs} OUTPUT_VARIABLE printed RESULT_VARIABLE result)
message("${printed}")
if(NOT result EQUAL 0 OR NOT printed MATCHES "functions [0-9][0-9][0-9]")
  message(FATAL_ERROR "a frame above ${LIMIT} bytes, or nothing was read")
endif()
