cmake_minimum_required(VERSION 3.22)
# Configures the command where its libraries are as vcpkg and Fedora have them: Eigen 5, whose version file takes no other major
# version, and stb's headers without a folder of their own. The headers are this machine's.
# Run as: cmake -DBUILD=... -DSOURCE=... -DGENERATOR=... -DCXX=... -DEIGEN=include_folder -DSTB=include_folder -P newer_libraries.cmake
set(work ${BUILD}/newer_libraries)
file(REMOVE_RECURSE ${work})
include(CMakePackageConfigHelpers)
set(CMAKE_SIZEOF_VOID_P 8)
set(CMAKE_BINARY_DIR ${work})
file(WRITE ${work}/prefix/share/eigen3/cmake/Eigen3Config.cmake
  "add_library(Eigen3::Eigen INTERFACE IMPORTED)\ntarget_include_directories(Eigen3::Eigen INTERFACE ${EIGEN})\n")
write_basic_package_version_file(${work}/prefix/share/eigen3/cmake/Eigen3ConfigVersion.cmake VERSION 5.0.1
  COMPATIBILITY SameMajorVersion ARCH_INDEPENDENT)
file(COPY ${STB}/stb_image.h ${STB}/stb_image_write.h DESTINATION ${work}/prefix/include)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
  -DPLIANT_TESTS=OFF -DPLIANT_LIBCAMERA=OFF -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
  RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${out}")
endif()
file(STRINGS ${work}/build/CMakeCache.txt found REGEX "^(Eigen3_DIR|PLIANT_STB_DIR):PATH=${work}/prefix/")
list(LENGTH found count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "other libraries were found: ${found}")
endif()
# A user's build does not fail where a newer compiler warns of more.
file(STRINGS ${work}/build/compile_commands.json errors REGEX " -Werror ")
if(errors)
  message(FATAL_ERROR "warnings are errors in a user's build")
endif()
message(STATUS "${found}")
