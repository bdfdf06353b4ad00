# SuiteSparseQR and CHOLMOD: SuiteSparse 5.12 has neither a CMake config nor a pkg-config file.
# Gives SuiteSparse::SPQR, under the GPL, and SuiteSparse::config, which is free of it.
find_path(SuiteSparseQR_INCLUDE_DIR SuiteSparseQR.hpp PATH_SUFFIXES suitesparse)
find_library(SuiteSparseQR_LIBRARY spqr)
find_library(SuiteSparseQR_CHOLMOD_LIBRARY cholmod)
find_library(SuiteSparseQR_CONFIG_LIBRARY suitesparseconfig)
mark_as_advanced(SuiteSparseQR_INCLUDE_DIR SuiteSparseQR_LIBRARY SuiteSparseQR_CHOLMOD_LIBRARY SuiteSparseQR_CONFIG_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparseQR REQUIRED_VARS
  SuiteSparseQR_LIBRARY SuiteSparseQR_CHOLMOD_LIBRARY SuiteSparseQR_CONFIG_LIBRARY SuiteSparseQR_INCLUDE_DIR)
if(SuiteSparseQR_FOUND AND NOT TARGET SuiteSparse::SPQR)
  add_library(SuiteSparse::config INTERFACE IMPORTED)
  target_include_directories(SuiteSparse::config SYSTEM INTERFACE ${SuiteSparseQR_INCLUDE_DIR})
  target_link_libraries(SuiteSparse::config INTERFACE ${SuiteSparseQR_CONFIG_LIBRARY})
  add_library(SuiteSparse::SPQR INTERFACE IMPORTED)
  target_link_libraries(SuiteSparse::SPQR INTERFACE
    ${SuiteSparseQR_LIBRARY} ${SuiteSparseQR_CHOLMOD_LIBRARY} SuiteSparse::config)
endif()
