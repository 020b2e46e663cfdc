# The portable sources, for build systems other than ours: lists of absolute paths in `pliant_sources`, folders of public
# headers in `pliant_includes` and of the library's own in `pliant_private_includes`, and the flags that keep the bits and the size in `pliant_flags`. Eigen 3.4's folder is the
# caller's to add.
get_filename_component(pliant_root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
file(GLOB pliant_sources ${pliant_root}/src/*/*.cpp ${pliant_root}/platform/vision/*.cpp
  ${pliant_root}/platform/face/*.cpp ${pliant_root}/platform/track/*.cpp)
list(SORT pliant_sources)
set(pliant_includes ${pliant_root}/include)
set(pliant_private_includes ${pliant_root}/src ${pliant_root}/platform)
set(pliant_flags -ffp-contract=off -fno-math-errno -fno-tree-slp-vectorize)
set(pliant_cxx_flags -fno-exceptions -fno-rtti -fno-threadsafe-statics)
set(pliant_definitions EIGEN_DONT_VECTORIZE EIGEN_NO_MALLOC EIGEN_NO_IO EIGEN_MAX_STATIC_ALIGN_BYTES=8)
