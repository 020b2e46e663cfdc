cmake_minimum_required(VERSION 3.22)
# The portable libraries must not reach a heap, exceptions, RTTI or libm: no such symbol is left undefined in them.
# Run as: cmake -DNM=... -DLIBRARIES="a;b" -P symbols.cmake
set(forbidden
  "^(malloc|calloc|realloc|free|aligned_alloc|posix_memalign|abort|exit)$"
  "^_Zn[wa]" "^_Zd[la]"                       # operator new and delete
  "^__cxa_" "^_Unwind" "^__gxx_personality" "^_ZTI" "^_ZTVN10__cxxabi"
  "^_ZNSt" "^_ZSt"                            # the C++ standard library's code
  "^(sin|cos|tan|exp|log|pow|atan2|acos|asin|floor|ceil|round|fmod|hypot|cbrt)f?$"
  "^(printf|puts|fopen|fwrite|memalign)")
set(found "")
foreach(library IN LISTS LIBRARIES)
  execute_process(COMMAND ${NM} --undefined-only --format=posix ${library} OUTPUT_VARIABLE text RESULT_VARIABLE result
    ERROR_QUIET)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${NM} cannot read ${library}")
  endif()
  string(REPLACE "\n" ";" lines "${text}")
  list(LENGTH lines count)
  if(count LESS 10)
    message(FATAL_ERROR "${library}: hardly any symbols; is it the right file?")
  endif()
  foreach(line IN LISTS lines)
    string(REGEX REPLACE " .*" "" symbol "${line}")
    foreach(pattern IN LISTS forbidden)
      if(symbol MATCHES "${pattern}")
        list(APPEND found "${symbol}")
      endif()
    endforeach()
  endforeach()
endforeach()
if(found)
  list(REMOVE_DUPLICATES found)
  message(FATAL_ERROR "forbidden symbols: ${found}")
endif()
message(STATUS "no forbidden symbol in ${LIBRARIES}")
