cmake_minimum_required(VERSION 3.22)
# The portable libraries must not reach a heap, exceptions, RTTI or libm: no such symbol is left undefined in them, and none
# is in the linked images. Run as: cmake -DNM=... -DLIBRARIES="a;b" [-DIMAGES="c;d"] -P symbols.cmake
set(forbidden
  "^_?(malloc|calloc|realloc|free|aligned_alloc|posix_memalign|memalign)(_r)?$" "^_?sbrk(_r)?$" "^(abort|exit)$"
  "^_Zn[wa]" "^_Zd[la]"                       # operator new and delete
  "^__cxa_" "^_Unwind" "^__gxx_personality" "^_ZTI" "^_ZTVN10__cxxabi"
  "^_ZNSt" "^_ZSt"                            # the C++ standard library's code
  "^(sin|cos|tan|exp|log|pow|atan2|acos|asin|floor|ceil|round|fmod|hypot|cbrt)f?$"
  "^(printf|puts|fopen|fwrite)")
set(found "")
function(search file)
  execute_process(COMMAND ${NM} ${ARGN} --format=posix ${file} OUTPUT_VARIABLE text RESULT_VARIABLE result ERROR_QUIET)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${NM} cannot read ${file}")
  endif()
  string(REPLACE "\n" ";" lines "${text}")
  list(LENGTH lines count)
  if(count LESS 10)
    message(FATAL_ERROR "${file}: hardly any symbols; is it the right file?")
  endif()
  foreach(line IN LISTS lines)
    string(REGEX REPLACE " .*" "" symbol "${line}")
    foreach(pattern IN LISTS forbidden)
      if(symbol MATCHES "${pattern}")
        list(APPEND found "${symbol}")
      endif()
    endforeach()
  endforeach()
  set(found ${found} PARENT_SCOPE)
endfunction()

foreach(library IN LISTS LIBRARIES)
  search(${library} --undefined-only)
endforeach()
foreach(image IN LISTS IMAGES)
  search(${image})
endforeach()
if(found)
  list(REMOVE_DUPLICATES found)
  message(FATAL_ERROR "forbidden symbols: ${found}")
endif()
message(STATUS "no forbidden symbol in ${LIBRARIES} ${IMAGES}")
