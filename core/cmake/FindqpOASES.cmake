# qpOASES: the CMake package of its version 3.2 has no target.
# Gives qpOASES::qpOASES. A static one brings a few BLAS and LAPACK routines of its own under their usual names, which only
# do what qpOASES needs: they are kept from other libraries (MUMPS crashed on them).
find_path(qpOASES_INCLUDE_DIR qpOASES.hpp)
find_library(qpOASES_LIBRARY qpOASES PATH_SUFFIXES libs)
mark_as_advanced(qpOASES_INCLUDE_DIR qpOASES_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(qpOASES REQUIRED_VARS qpOASES_LIBRARY qpOASES_INCLUDE_DIR)
if(qpOASES_FOUND AND NOT TARGET qpOASES::qpOASES)
  add_library(qpOASES::qpOASES INTERFACE IMPORTED)
  target_include_directories(qpOASES::qpOASES SYSTEM INTERFACE ${qpOASES_INCLUDE_DIR})
  target_link_libraries(qpOASES::qpOASES INTERFACE ${qpOASES_LIBRARY})
  get_filename_component(qpOASES_name ${qpOASES_LIBRARY} NAME)
  target_link_options(qpOASES::qpOASES INTERFACE LINKER:--exclude-libs,${qpOASES_name})
endif()
