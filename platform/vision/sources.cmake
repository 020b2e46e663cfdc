target_sources(pliant_platform PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/pyramid.cpp
  ${CMAKE_CURRENT_LIST_DIR}/shift.cpp
  ${CMAKE_CURRENT_LIST_DIR}/directions.cpp
  ${CMAKE_CURRENT_LIST_DIR}/edges.cpp
  ${CMAKE_CURRENT_LIST_DIR}/corner_scores.cpp
  ${CMAKE_CURRENT_LIST_DIR}/corners.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch_align.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch_refine.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch_result.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch_kernels.cpp
  ${CMAKE_CURRENT_LIST_DIR}/patch_template.cpp)
