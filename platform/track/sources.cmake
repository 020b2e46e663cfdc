target_sources(pliant_platform PRIVATE ${CMAKE_CURRENT_LIST_DIR}/tracker.cpp)
