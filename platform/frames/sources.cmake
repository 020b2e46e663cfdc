target_sources(pliant_host PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/camera_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/folder.cpp
  ${CMAKE_CURRENT_LIST_DIR}/frame_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/pnm.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_header.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_writer.cpp)
if(TARGET pliant_libcamera)
  add_library(pliant_camera MODULE ${CMAKE_CURRENT_LIST_DIR}/camera_module.cpp)
  target_include_directories(pliant_camera PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(pliant_camera PRIVATE pliant_libcamera pliant_warnings)
  set_target_properties(pliant_camera PROPERTIES PREFIX "" OUTPUT_NAME pliant-camera
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  file(RELATIVE_PATH pliant_module_dir ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/pliant)
  target_include_directories(pliant_host PRIVATE $<TARGET_PROPERTY:pliant_libcamera,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_definitions(pliant_host PRIVATE PLIANT_HAS_LIBCAMERA=1
    PLIANT_CAMERA_MODULE_DIR="${pliant_module_dir}")
  target_link_libraries(pliant_host PRIVATE ${CMAKE_DL_LIBS})
  add_dependencies(pliant_host pliant_camera)
else()
  target_compile_definitions(pliant_host PRIVATE PLIANT_HAS_LIBCAMERA=0)
endif()
