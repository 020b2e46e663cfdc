cmake_minimum_required(VERSION 3.22)
# Installs the build into a folder of its own and builds a user's project against it: by find_package, as a
# subdirectory, and with the flags of pkg-config. Run as: cmake -DBUILD=... -DSOURCE=... -DCXX=... -P consumer.cmake
set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${out}")
  endif()
  message(STATUS "${out}")
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
set(common -G Ninja -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/system/consumer -B ${work}/package ${common} -DCMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/package)
run(${work}/package/consumer)

run(${CMAKE_COMMAND} -S ${SOURCE}/tests/system/consumer -B ${work}/subdirectory ${common} -DPLIANT_SOURCE_DIR=${SOURCE})
run(${CMAKE_COMMAND} --build ${work}/subdirectory --target consumer)
run(${work}/subdirectory/consumer)

find_program(pkg_config NAMES pkg-config pkgconf)
if(pkg_config)
  file(GLOB_RECURSE pc ${work}/prefix/*.pc)
  get_filename_component(folder ${pc} DIRECTORY)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${folder} ${pkg_config}
    --define-variable=prefix=${work}/prefix --cflags --libs pliant
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(${CXX} -std=c++17 ${SOURCE}/tests/system/consumer/main.cpp ${flags} -o ${work}/by_pkg_config)
  run(${work}/by_pkg_config)
endif()
