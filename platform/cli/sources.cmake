# Pictures are read and written by stb (Debian: libstb-dev), a header that only image_io.cpp includes.
find_path(PLIANT_STB_INCLUDE_DIR stb/stb_image.h REQUIRED)
set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/image_io.cpp PROPERTIES
  INCLUDE_DIRECTORIES ${PLIANT_STB_INCLUDE_DIR}
  # Its JPEG writer shifts negative numbers.
  COMPILE_OPTIONS -fno-sanitize=shift)

# The pages that commands write are templates in pages/, each compiled in as a string.
foreach(page Points Report)
  string(TOLOWER ${page} page_file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/pages/${page_file}.html)
  file(READ ${CMAKE_CURRENT_LIST_DIR}/pages/${page_file}.html page_text)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/page_${page_file}.cpp @ONLY CONTENT [[
#include "cli/page.hpp"
namespace pliant::cli {
const char* const k@page@Page = R"page(@page_text@)page";
}
]])
  target_sources(pliant_host PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/page_${page_file}.cpp)
endforeach()

target_sources(pliant_host PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/animate_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/animation_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/args.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bake_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bake_sizes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_fields.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_klt.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_klt_motion.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_mcd.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_fit.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_fit_problem.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_mesh.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_occlusion.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_rows.cpp
  ${CMAKE_CURRENT_LIST_DIR}/calibration.cpp
  ${CMAKE_CURRENT_LIST_DIR}/camera_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench_track.cpp
  ${CMAKE_CURRENT_LIST_DIR}/command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/csv.cpp
  ${CMAKE_CURRENT_LIST_DIR}/draw.cpp
  ${CMAKE_CURRENT_LIST_DIR}/files.cpp
  ${CMAKE_CURRENT_LIST_DIR}/fit_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/fit_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/glb.cpp
  ${CMAKE_CURRENT_LIST_DIR}/image.cpp
  ${CMAKE_CURRENT_LIST_DIR}/image_io.cpp
  ${CMAKE_CURRENT_LIST_DIR}/info_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/json.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_curve.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_figure.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_files.cpp
  ${CMAKE_CURRENT_LIST_DIR}/model_mesh.cpp
  ${CMAKE_CURRENT_LIST_DIR}/morph.cpp
  ${CMAKE_CURRENT_LIST_DIR}/occlusion.cpp
  ${CMAKE_CURRENT_LIST_DIR}/overlay.cpp
  ${CMAKE_CURRENT_LIST_DIR}/page.cpp
  ${CMAKE_CURRENT_LIST_DIR}/photo_sights.cpp
  ${CMAKE_CURRENT_LIST_DIR}/photo_texture.cpp
  ${CMAKE_CURRENT_LIST_DIR}/plan.cpp
  ${CMAKE_CURRENT_LIST_DIR}/plan_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/points_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/points_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/raster.cpp
  ${CMAKE_CURRENT_LIST_DIR}/render_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/render_grid.cpp
  ${CMAKE_CURRENT_LIST_DIR}/retarget.cpp
  ${CMAKE_CURRENT_LIST_DIR}/scene.cpp
  ${CMAKE_CURRENT_LIST_DIR}/self_start.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sheet.cpp
  ${CMAKE_CURRENT_LIST_DIR}/shown_mesh.cpp
  ${CMAKE_CURRENT_LIST_DIR}/start.cpp
  ${CMAKE_CURRENT_LIST_DIR}/surface_sheet.cpp
  ${CMAKE_CURRENT_LIST_DIR}/svg_chart.cpp
  ${CMAKE_CURRENT_LIST_DIR}/track_command.cpp
  ${CMAKE_CURRENT_LIST_DIR}/track_output.cpp
  ${CMAKE_CURRENT_LIST_DIR}/track_report.cpp
  ${CMAKE_CURRENT_LIST_DIR}/track_table.cpp
  ${CMAKE_CURRENT_LIST_DIR}/tracker_limits.cpp
  ${CMAKE_CURRENT_LIST_DIR}/truth.cpp)

add_executable(pliant ${CMAKE_CURRENT_LIST_DIR}/main.cpp)
target_link_libraries(pliant PRIVATE pliant_host pliant_warnings)
set_target_properties(pliant PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
# What the program uses of the C++ library, in the program: the whole of it costs a megabyte of memory more. A sanitizer wants
# the shared one.
include(CheckLinkerFlag)
set(pliant_lean "-static-libstdc++;-static-libgcc;-Wl,--gc-sections")
check_linker_flag(CXX "${pliant_lean}" PLIANT_CAN_LINK_LEAN)
if(PLIANT_CAN_LINK_LEAN AND NOT CMAKE_CXX_FLAGS MATCHES "sanitize")
  target_link_options(pliant PRIVATE ${pliant_lean})
endif()
