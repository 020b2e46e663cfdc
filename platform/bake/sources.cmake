target_sources(pliant_host PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/bake.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bake_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/base_mesh.cpp
  ${CMAKE_CURRENT_LIST_DIR}/cage.cpp
  ${CMAKE_CURRENT_LIST_DIR}/chart_raster.cpp
  ${CMAKE_CURRENT_LIST_DIR}/face_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/field_grid.cpp
  ${CMAKE_CURRENT_LIST_DIR}/moves.cpp
  ${CMAKE_CURRENT_LIST_DIR}/paint.cpp
  ${CMAKE_CURRENT_LIST_DIR}/skin_boundary.cpp
  ${CMAKE_CURRENT_LIST_DIR}/subdivision.cpp
  ${CMAKE_CURRENT_LIST_DIR}/table_writer.cpp
  ${CMAKE_CURRENT_LIST_DIR}/text_table.cpp
  ${CMAKE_CURRENT_LIST_DIR}/triangulation.cpp)
