# The host's side: the prepared files, and the programs' output on this host.
set(prepared ${CMAKE_CURRENT_BINARY_DIR})
set(prepared ${prepared} PARENT_SCOPE)
add_executable(egg_table egg_table.cpp)
target_include_directories(egg_table PRIVATE ${PROJECT_SOURCE_DIR}/tests/support ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(egg_table PRIVATE pliant_host pliant_test_models pliant_warnings)
add_custom_command(OUTPUT egg.cpp DEPENDS egg_table COMMAND egg_table egg.cpp)

target_compile_options(egg_table PRIVATE $<$<CONFIG:Release>:-O0>)

# The face as firmware keeps it, and a person who turns the head, talks and blinks.
set(fixtures ${PROJECT_SOURCE_DIR}/fixtures)
set(start_awk ${CMAKE_CURRENT_SOURCE_DIR}/start.awk)
set(points_awk ${CMAKE_CURRENT_SOURCE_DIR}/points.awk)
add_custom_command(OUTPUT face.plm face.cpp DEPENDS pliant ${face_tables}
  COMMAND pliant bake ${fixtures}/face -o face.plm --embed face.cpp --bits 8 --size 64)
add_custom_command(OUTPUT frames.y4m start.hpp points.h DEPENDS pliant face.plm ${fixtures}/frames/motion.awk ${start_awk}
    ${points_awk}
  COMMAND awk -v frames=40 -f ${fixtures}/frames/motion.awk > motion.csv
  COMMAND pliant render face.plm --params motion.csv --size 320x240 --focal 448 -o frames.y4m --truth truth.csv
    --truth-points truth_points.csv
  COMMAND awk -F, -v f=448 -v width=320 -v height=240 -f ${start_awk} truth.csv > start.hpp
  COMMAND awk -F, -f ${points_awk} truth_points.csv > points.h)

# One target writes them: of two that list them, each would, and at the same time under Make.
add_custom_target(pliant_tables DEPENDS egg.cpp face.cpp start.hpp points.h frames.y4m)

add_library(pliant_embedded_face STATIC face.cpp)
target_compile_features(pliant_embedded_face PRIVATE cxx_std_17)
target_include_directories(pliant_embedded_face PRIVATE ${PROJECT_SOURCE_DIR}/include)
add_dependencies(pliant_embedded_face pliant_tables)
pliant_program(firmware ${cortex_m}/firmware.cpp)
pliant_program(bad_input bad_input.cpp)
pliant_program(detection ${cortex_m}/firmware.cpp)
target_compile_definitions(detection PRIVATE PLIANT_FIRMWARE_DETECTS)
pliant_program(c_example ${cortex_m}/c_example.c)
foreach(program firmware bad_input detection c_example)
  target_link_libraries(${program} PRIVATE pliant_embedded_face)
endforeach()

set(outputs "")
foreach(program IN LISTS compared)
  add_dependencies(${program} pliant_tables)
  add_custom_command(OUTPUT ${program}.txt DEPENDS ${program} frames.y4m COMMAND ${program} > ${program}.txt)
  list(APPEND outputs ${program}.txt)
endforeach()
add_custom_target(pliant_prepared ALL DEPENDS ${outputs})
add_dependencies(pliant_prepared pliant_tables)
