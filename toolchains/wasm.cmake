# WebAssembly by Debian's emscripten; programs run under Node.js, which reads the build machine's files for them.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_C_FLAGS_INIT "-msimd128")
set(CMAKE_CXX_FLAGS_INIT "-msimd128")
# One file, since Node.js 18 and later would fetch a second one from the network. Above -O1 the linker asks for a JavaScript
# optimiser that not every Node.js finds.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-O1 -sSINGLE_FILE=1 -sNODERAWFS=1 -sEXIT_RUNTIME=1 -sINITIAL_MEMORY=64MB")
set(CMAKE_EXE_LINKER_FLAGS_RELEASE "")
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(CMAKE_CROSSCOMPILING_EMULATOR /usr/bin/node)
