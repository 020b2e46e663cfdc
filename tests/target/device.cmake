# A target's side. PLIANT_HOST_BUILD is the folder of a host build with tests; without one, one is made in here.
set(PLIANT_HOST_BUILD "" CACHE PATH "A finished host build, for the files that it prepares")
if(PLIANT_HOST_BUILD)
  get_filename_component(prepared ${PLIANT_HOST_BUILD}/tests/target ABSOLUTE BASE_DIR ${CMAKE_BINARY_DIR})
  add_custom_target(pliant_prepared)
else()
  include(ExternalProject)
  set(prepared ${PROJECT_BINARY_DIR}/host/tests/target)
  ExternalProject_Add(pliant_prepared SOURCE_DIR ${PROJECT_SOURCE_DIR} BINARY_DIR ${PROJECT_BINARY_DIR}/host
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=Release BUILD_COMMAND ${CMAKE_COMMAND} --build . --target pliant_prepared
    INSTALL_COMMAND "" BUILD_ALWAYS ON
    BUILD_BYPRODUCTS ${prepared}/egg.cpp ${prepared}/face.cpp ${prepared}/start.hpp
      ${prepared}/points.h)
endif()

set(prepared ${prepared} PARENT_SCOPE)

# pliant_image(NAME sources...): a program and its run on the target, in the folder of the prepared files. Where the host
# keeps NAME.txt, the output of its own run, the two are compared.
set(images "")
function(pliant_image name)
  pliant_program(${name} ${ARGN})
  add_dependencies(${name} pliant_prepared)
  set(images ${images} $<TARGET_FILE:${name}> PARENT_SCOPE)
  set(expected "")
  if(name IN_LIST compared)
    set(expected ${prepared}/${name}.txt)
  endif()
  if(name STREQUAL detection AND NOT name IN_LIST compared)
    return()  # no learnt tables, no face
  endif()
  add_test(NAME target_${name} WORKING_DIRECTORY ${prepared} COMMAND ${CMAKE_COMMAND}
    "-DPROGRAM=${CMAKE_CROSSCOMPILING_EMULATOR};$<TARGET_FILE:${name}>" -DEXPECTED=${expected}
    -DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${name}.txt -P ${CMAKE_CURRENT_SOURCE_DIR}/run_image.cmake)
  if(WIN32)  # Wine's first program sets it up for the others
    set_tests_properties(target_${name} PROPERTIES RUN_SERIAL ON)
  endif()
endfunction()

pliant_image(firmware ${cortex_m}/firmware.cpp ${prepared}/face.cpp)
pliant_image(bad_input bad_input.cpp ${prepared}/face.cpp)
pliant_image(detection ${cortex_m}/firmware.cpp ${prepared}/face.cpp)
target_compile_definitions(detection PRIVATE PLIANT_FIRMWARE_DETECTS)
pliant_image(c_example ${cortex_m}/c_example.c ${prepared}/face.cpp)

if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")  # there the test programs do this
  pliant_image(digest digest_board.cpp ../support/digest_run.cpp ${prepared}/egg.cpp)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
  add_test(NAME symbols COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} "-DIMAGES=${images}"
    "-DLIBRARIES=$<TARGET_FILE:pliant_core>;$<TARGET_FILE:pliant_track>"
    -P ${PROJECT_SOURCE_DIR}/tests/system/symbols.cmake)
  add_test(NAME code_size_with_detection COMMAND ${CMAKE_COMMAND} -DMAP=$<TARGET_FILE:detection>.map -DLIMIT=131072
    -P ${CMAKE_CURRENT_SOURCE_DIR}/code_size.cmake)
  add_test(NAME code_size COMMAND ${CMAKE_COMMAND} -DMAP=$<TARGET_FILE:firmware>.map -DLIMIT=98304
    -P ${CMAKE_CURRENT_SOURCE_DIR}/code_size.cmake)
endif()
