# Siconos' numerics library: its own CMake package asks for the program `siconos`, and has no file for pkg-config.
# Gives SiconosNumerics::SiconosNumerics.
find_path(SiconosNumerics_INCLUDE_DIR siconos/numerics/fc3d_Solvers.h)
find_path(SiconosNumerics_SUITESPARSE_DIR cs.h PATH_SUFFIXES suitesparse)
find_library(SiconosNumerics_LIBRARY siconos_numerics)
mark_as_advanced(SiconosNumerics_INCLUDE_DIR SiconosNumerics_SUITESPARSE_DIR SiconosNumerics_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SiconosNumerics REQUIRED_VARS SiconosNumerics_LIBRARY SiconosNumerics_INCLUDE_DIR
  SiconosNumerics_SUITESPARSE_DIR)
if(SiconosNumerics_FOUND AND NOT TARGET SiconosNumerics::SiconosNumerics)
  add_library(SiconosNumerics::SiconosNumerics INTERFACE IMPORTED)
  target_include_directories(SiconosNumerics::SiconosNumerics SYSTEM INTERFACE
    ${SiconosNumerics_INCLUDE_DIR}/siconos ${SiconosNumerics_INCLUDE_DIR}/siconos/numerics
    ${SiconosNumerics_SUITESPARSE_DIR})
  target_link_libraries(SiconosNumerics::SiconosNumerics INTERFACE ${SiconosNumerics_LIBRARY})
endif()
