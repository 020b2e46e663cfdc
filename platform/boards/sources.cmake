# The portable libraries, for build systems other than ours:
#   pliant_sources           the source files
#   pliant_includes          the folder of the public headers
#   pliant_private_includes  the folders of the private headers
#   pliant_flags             compiler flags that keep the results the same bits everywhere
#   pliant_cxx_flags         flags without which heap and exceptions would be linked
# All paths are absolute. No other library is needed.
get_filename_component(pliant_root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
file(GLOB pliant_sources ${pliant_root}/src/*/*.cpp ${pliant_root}/platform/vision/*.cpp
  ${pliant_root}/platform/face/*.cpp ${pliant_root}/platform/print/*.cpp ${pliant_root}/platform/track/*.cpp)
list(SORT pliant_sources)
set(pliant_includes ${pliant_root}/include)
set(pliant_private_includes ${pliant_root}/src ${pliant_root}/platform)
set(pliant_flags -ffp-contract=off -fno-math-errno -fno-tree-slp-vectorize)
set(pliant_cxx_flags -fno-exceptions -fno-rtti -fno-threadsafe-statics)
