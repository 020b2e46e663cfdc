target_sources(pliant_host PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/folder.cpp
  ${CMAKE_CURRENT_LIST_DIR}/frame_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/pnm.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_header.cpp
  ${CMAKE_CURRENT_LIST_DIR}/y4m_writer.cpp)
