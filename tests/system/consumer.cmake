cmake_minimum_required(VERSION 3.22)
# Installs the build into a folder of its own, moves that, and builds a user's project against it, in C++ and in C: by find_package, as
# a subdirectory, and with the flags of pkg-config. A C program is linked by the C compiler, with nothing named by hand.
# Run as: cmake -DBUILD=... -DSOURCE=... -DGENERATOR=... -DCXX=... -DCC=... [-DLAUNCHER=ccache] -P consumer.cmake
set(work ${BUILD}/consumer)
set(project ${SOURCE}/tests/system/consumer)
file(REMOVE_RECURSE ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${out}")
  endif()
  message(STATUS "${out}")
endfunction()

# configure(NAME PROGRAM options...)
function(configure name program)
  run(${CMAKE_COMMAND} -S ${project} -B ${work}/${name} -G ${GENERATOR} -DCONSUMER=${program} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_C_COMPILER=${CC} ${ARGN})
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/installed)
file(RENAME ${work}/installed ${work}/prefix)
foreach(program main.cpp main.c)
  configure(package_${program} ${program} -DCMAKE_PREFIX_PATH=${work}/prefix)
  run(${CMAKE_COMMAND} --build ${work}/package_${program})
  run(${work}/package_${program}/consumer)
endforeach()

# As a subdirectory of a project in C that names no build type: the library is optimised all the same.
# No other library is looked for. The libraries are static, and their sources are compiled one by one, whatever the project says of its own.
# Objects of the build that were compiled in the same way are taken from there.
set(launcher ${LAUNCHER})
if(GENERATOR STREQUAL "Ninja")
  find_program(ninja NAMES ninja ninja-build REQUIRED)
  execute_process(COMMAND ${ninja} -C ${BUILD} -t commands pliant_core pliant_track OUTPUT_FILE ${work}/commands
    COMMAND_ERROR_IS_FATAL ANY)
  set(launcher ${work}/launcher)
  file(WRITE ${launcher} "#!/bin/sh\nexec sh '${project}/reuse_object.sh' '${BUILD}' '${work}/commands' ${LAUNCHER} \"$@\"\n")
  file(CHMOD ${launcher} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endif()
configure(subdirectory main.c -DPLIANT_SOURCE_DIR=${SOURCE} -DCMAKE_CXX_COMPILER_LAUNCHER=${launcher}
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DBUILD_SHARED_LIBS=ON -DCMAKE_UNITY_BUILD=ON -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON)
file(STRINGS ${work}/subdirectory/compile_commands.json commands REGEX "command.*/pliant_(core|track)\\.dir/")
foreach(command IN LISTS commands)
  if(NOT command MATCHES " -O2 ")
    message(FATAL_ERROR "compiled without optimisation: ${command}")
  endif()
endforeach()
run(${CMAKE_COMMAND} --build ${work}/subdirectory --target consumer --parallel 2)
run(${work}/subdirectory/consumer)
file(GLOB_RECURSE shared ${work}/subdirectory/libpliant_*.so)
if(shared)
  message(FATAL_ERROR "a shared library: ${shared}")
endif()
# In C++ it is configured only: the library would be what it was above. Folders are absolute, and not in one prefix.
configure(subdirectory_cxx main.cpp -DPLIANT_SOURCE_DIR=${SOURCE} -DCMAKE_INSTALL_PREFIX=${work}/apart/out
  -DCMAKE_INSTALL_LIBDIR=${work}/apart/lib -DCMAKE_INSTALL_INCLUDEDIR=${work}/apart/dev/include)
file(COPY ${work}/subdirectory_cxx/pliant/pliant.pc DESTINATION ${work}/apart/lib/pkgconfig)
file(MAKE_DIRECTORY ${work}/apart/out)

# vcpkg moves the CMake files beside the face.
file(GLOB_RECURSE config ${work}/prefix/*/pliantConfig.cmake)
file(COPY ${config} DESTINATION ${work}/vcpkg/share/pliant)
file(COPY ${work}/prefix/share/pliant/face.plm DESTINATION ${work}/vcpkg/share/pliant)
file(WRITE ${work}/vcpkg/share/pliant/pliantTargets.cmake "")
include(${work}/vcpkg/share/pliant/pliantConfig.cmake)
if(NOT pliant_FACE STREQUAL "${work}/vcpkg/share/pliant/face.plm")
  message(FATAL_ERROR "no face beside the moved CMake files: '${pliant_FACE}'")
endif()

# The C interface in C99, which has no _Static_assert.
file(WRITE ${work}/c99.c "#include <pliant/pliant.h>\nint in_c99(void);\nint in_c99(void) { return pliant_version() != 0; }\n")
run(${CC} -std=gnu99 -Wall -Wextra -Wconversion -pedantic-errors -Werror -I${work}/prefix/include -c ${work}/c99.c -o ${work}/c99.o)

# The same table for a program in C and for one in C++.
run(${BUILD}/pliant bake ${SOURCE}/fixtures/sheet -o ${work}/sheet.plm --embed ${work}/sheet.c)
run(${CC} -std=c11 -Wall -Wextra -pedantic-errors -Werror -c ${work}/sheet.c -o ${work}/sheet_c.o)
run(${CXX} -std=c++17 -x c++ -Wall -Wextra -pedantic-errors -Werror -c ${work}/sheet.c -o ${work}/sheet_cxx.o)

# In a shared object, and installed as a part of another project.
configure(shared main.cpp -DCMAKE_PREFIX_PATH=${work}/prefix -DCONSUMER_IS_SHARED=ON)
run(${CMAKE_COMMAND} --build ${work}/shared)
run(${CMAKE_COMMAND} --install ${work}/subdirectory --prefix ${work}/of_subproject)
if(NOT EXISTS ${work}/of_subproject/include/pliant/tracker.hpp OR NOT EXISTS ${work}/of_subproject/bin/consumer)
  message(FATAL_ERROR "the project with pliant inside was not installed whole")
endif()
if(EXISTS ${work}/of_subproject/share/doc/consumer OR NOT EXISTS ${work}/of_subproject/share/doc/pliant/LICENSE)
  message(FATAL_ERROR "pliant's documents are not in a folder of its own, but in that of the project it is part of")
endif()

# A program that is checked by the thread sanitizer, where there is one, comes as far as main.
set(tsan -std=c++17 -O1 -fsanitize=thread -I${SOURCE}/include -I${SOURCE}/src -I${SOURCE}/platform)
file(WRITE ${work}/empty.cpp "int main() {}\n")
execute_process(COMMAND ${CXX} ${tsan} ${work}/empty.cpp -o ${work}/empty RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
if(result EQUAL 0)
  execute_process(COMMAND ${work}/empty RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
endif()
if(result EQUAL 0)
  file(WRITE ${work}/tsan.cpp "#include <pliant/pyramid.hpp>\nint main() { return pliant::Pyramid().levels(); }\n")
  run(${CXX} ${tsan} ${work}/tsan.cpp ${SOURCE}/platform/vision/pyramid.cpp -o ${work}/tsan)
  run(${work}/tsan)
endif()

find_program(pkg_config NAMES pkg-config pkgconf)
if(pkg_config)
  foreach(variable "--cflags-only-I;dev/include" "--libs-only-L;lib")
    list(GET variable 0 option)
    list(GET variable 1 folder)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${work}/apart/lib/pkgconfig ${pkg_config} ${option} pliant
      OUTPUT_VARIABLE flag OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    string(SUBSTRING "${flag}" 2 -1 flag)
    get_filename_component(flag "${flag}" ABSOLUTE)
    if(NOT flag STREQUAL "${work}/apart/${folder}")
      message(FATAL_ERROR "pkg-config gives ${flag}, where the folder is ${work}/apart/${folder}")
    endif()
  endforeach()
  file(GLOB_RECURSE pc ${work}/prefix/*.pc)
  get_filename_component(folder ${pc} DIRECTORY)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${folder} ${pkg_config}
    --cflags --libs pliant
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(${CXX} -std=c++17 ${project}/main.cpp ${flags} -o ${work}/by_pkg_config)
  run(${work}/by_pkg_config)
  run(${CC} -std=c11 -pedantic ${project}/main.c ${flags} -o ${work}/c_by_pkg_config)
  run(${work}/c_by_pkg_config)
endif()
