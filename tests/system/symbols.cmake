cmake_minimum_required(VERSION 3.22)
# The portable libraries must not reach a heap, exceptions, RTTI or libm: no such symbol is left undefined in them, and none
# is in the linked images. Run as: cmake -DNM=... -DLIBRARIES="a;b" [-DIMAGES="c;d"] -P symbols.cmake
set(forbidden
  "^_?(malloc|calloc|realloc|free|aligned_alloc|posix_memalign|memalign)(_r)?$" "^_?sbrk(_r)?$" "^(abort|exit)$"
  "^_Zn[wa]" "^_Zd[la]"                       # operator new and delete
  "^__cxa_" "^_Unwind" "^__gxx_personality" "^_ZTI" "^_ZTVN10__cxxabi"
  "^_ZNSt" "^_ZSt"                            # the C++ standard library's code
  "^(a?(sin|cos|tan)h?|sincos|atan2|exp|exp2|exp10|expm1|log|log2|log10|log1p|i?logb|pow|cbrt|hypot|erfc?|[lt]gamma)[fl]?$"
  "^(floor|ceil|trunc|l?l?(round|rint)|nearbyint|fmod|remainder|remquo|modf|frexp|ldexp|scalbl?n|fma|fdim|nextafter)[fl]?$"
  "^(v?[fs]?n?printf|v?[fs]?scanf|puts|fopen|fwrite|strto[a-z]+|ato[a-z]+)$")
# The list knows what a rounding, a power and a number as text call.
foreach(symbol lroundf truncf fmaf exp2f log10f atanf tanhf ldexpf llrint pow printf snprintf strtof)
  set(is_known FALSE)
  foreach(pattern IN LISTS forbidden)
    if(symbol MATCHES "${pattern}")
      set(is_known TRUE)
    endif()
  endforeach()
  if(NOT is_known)
    message(FATAL_ERROR "${symbol} would not be found")
  endif()
endforeach()
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
