# OSQP 1: the CMake package of its sources without their git history says version 0, and 0.6 has targets of the same names.
# Gives OSQP::OSQP, the static library where there is one.
find_path(OSQP_INCLUDE_DIR osqp_api_functions.h PATH_SUFFIXES osqp)  # not in 0.6
find_library(OSQP_LIBRARY NAMES osqpstatic osqp)
mark_as_advanced(OSQP_INCLUDE_DIR OSQP_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OSQP REQUIRED_VARS OSQP_LIBRARY OSQP_INCLUDE_DIR)
if(OSQP_FOUND AND NOT TARGET OSQP::OSQP)
  add_library(OSQP::OSQP INTERFACE IMPORTED)
  target_include_directories(OSQP::OSQP SYSTEM INTERFACE ${OSQP_INCLUDE_DIR})
  target_link_libraries(OSQP::OSQP INTERFACE ${OSQP_LIBRARY} ${CMAKE_DL_LIBS})
endif()
