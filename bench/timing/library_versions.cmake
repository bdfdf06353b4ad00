# LIBRARY_VERSIONS: "Eigen 3.4.0,CHOLMOD 3.0.14,...", read from headers and pkg-config; a library that is not there is
# left out.

set(LIBRARY_VERSIONS "Eigen ${Eigen3_VERSION}")

# NAME MODULE pairs.
foreach(pair "Ipopt ipopt" "NLopt nlopt" "Bullet bullet-float64" "HDF5 hdf5-serial" "MPFR mpfr" "GMP gmp" "OpenBLAS openblas"
             "GoogleBenchmark benchmark")
  separate_arguments(pair)
  list(GET pair 0 name)
  list(GET pair 1 module)
  execute_process(COMMAND ${PKG_CONFIG_EXECUTABLE} --modversion ${module} OUTPUT_VARIABLE version
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE missing)
  if(NOT missing)
    string(APPEND LIBRARY_VERSIONS ",${name} ${version}")
  endif()
endforeach()

find_package(MuJoCo QUIET)
if(MuJoCo_FOUND)
  string(APPEND LIBRARY_VERSIONS ",MuJoCo ${MuJoCo_VERSION}")
endif()

# version_of(NAME HEADER MACRO...): the numbers or strings of these macros, joined by dots.
function(version_of NAME HEADER)
  find_file(header_${NAME} ${HEADER} PATH_SUFFIXES suitesparse)
  mark_as_advanced(header_${NAME})
  if(header_${NAME})
    set(numbers)
    foreach(macro ${ARGN})
      file(STRINGS ${header_${NAME}} line REGEX "#[ ]*define[ ]+${macro}[ ]" LIMIT_COUNT 1)
      if(line MATCHES "${macro}[ ]+\"?([0-9._]+)")
        list(APPEND numbers ${CMAKE_MATCH_1})
      endif()
    endforeach()
    string(REPLACE ";" "." version "${numbers}")
    string(REPLACE "_" "." version "${version}")
    set(LIBRARY_VERSIONS "${LIBRARY_VERSIONS},${NAME} ${version}" PARENT_SCOPE)
  endif()
endfunction()
version_of(SuiteSparse SuiteSparse_config.h SUITESPARSE_MAIN_VERSION SUITESPARSE_SUB_VERSION SUITESPARSE_SUBSUB_VERSION)
version_of(CHOLMOD cholmod_core.h CHOLMOD_MAIN_VERSION CHOLMOD_SUB_VERSION CHOLMOD_SUBSUB_VERSION)
version_of(SuiteSparseQR SuiteSparseQR_definitions.h SPQR_MAIN_VERSION SPQR_SUB_VERSION SPQR_SUBSUB_VERSION)
version_of(Boost boost/version.hpp BOOST_LIB_VERSION)
version_of(CGAL CGAL/version.h CGAL_VERSION)
