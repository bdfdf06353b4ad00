# DAQP: the CMake package of its version 0.9 lies outside of the folders that CMake searches, under names of no namespace.
# Gives DAQP::DAQP, the static library where there is one.
find_path(DAQP_INCLUDE_DIR daqp/api.h)
find_library(DAQP_LIBRARY NAMES daqpstat daqp)
mark_as_advanced(DAQP_INCLUDE_DIR DAQP_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(DAQP REQUIRED_VARS DAQP_LIBRARY DAQP_INCLUDE_DIR)
if(DAQP_FOUND AND NOT TARGET DAQP::DAQP)
  add_library(DAQP::DAQP INTERFACE IMPORTED)
  target_include_directories(DAQP::DAQP SYSTEM INTERFACE ${DAQP_INCLUDE_DIR})
  target_link_libraries(DAQP::DAQP INTERFACE ${DAQP_LIBRARY})
endif()
