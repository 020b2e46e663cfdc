target_sources(pliant_platform PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/edge_search.cpp
  ${CMAKE_CURRENT_LIST_DIR}/c_api.cpp
  ${CMAKE_CURRENT_LIST_DIR}/key_frames.cpp
  ${CMAKE_CURRENT_LIST_DIR}/landmark_fit.cpp
  ${CMAKE_CURRENT_LIST_DIR}/looking.cpp
  ${CMAKE_CURRENT_LIST_DIR}/model_finder.cpp
  ${CMAKE_CURRENT_LIST_DIR}/model_picture.cpp
  ${CMAKE_CURRENT_LIST_DIR}/part_search.cpp
  ${CMAKE_CURRENT_LIST_DIR}/personal_landmarks.cpp
  ${CMAKE_CURRENT_LIST_DIR}/picture_search.cpp
  ${CMAKE_CURRENT_LIST_DIR}/seeding.cpp
  ${CMAKE_CURRENT_LIST_DIR}/small_picture.cpp
  ${CMAKE_CURRENT_LIST_DIR}/surface_offset.cpp
  ${CMAKE_CURRENT_LIST_DIR}/surface_texture.cpp
  ${CMAKE_CURRENT_LIST_DIR}/tracker.cpp)
