target_sources(pliant_host PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/camera_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/folder.cpp
  ${CMAKE_CURRENT_LIST_DIR}/frame_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/pnm.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_header.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_writer.cpp)
if(TARGET pliant_libcamera)
  target_link_libraries(pliant_host PRIVATE pliant_libcamera)
  target_compile_definitions(pliant_host PRIVATE PLIANT_HAS_LIBCAMERA=1)
else()
  target_compile_definitions(pliant_host PRIVATE PLIANT_HAS_LIBCAMERA=0)
endif()
