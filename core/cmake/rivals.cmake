# The libraries of optional solvers, one line each:
#   zwang_rival_NAME  package TARGET...   the first target that the package gives is linked
# NAME is that of solvers/rivals/NAME.cpp. -DZWANG_NAME_DIR names the library's prefix, of an install or a build.
set(zwang_rivals mujoco daqp piqp osqp proxqp qpoases)
set(zwang_rival_mujoco MuJoCo MuJoCo::MuJoCo)
set(zwang_rival_daqp DAQP DAQP::DAQP)
set(zwang_rival_piqp piqp piqp::piqp_header_only)
set(zwang_rival_osqp OSQP OSQP::OSQP)
set(zwang_rival_proxqp proxsuite proxsuite::proxsuite-vectorized proxsuite::proxsuite)
set(zwang_rival_qpoases qpOASES qpOASES::qpOASES)

# zwang_find_rival(NAME): sets zwang_rival_target, empty where the library is absent. A prefix that was named must hold it.
macro(zwang_find_rival NAME)
  string(TOUPPER ZWANG_${NAME}_DIR zwang_hint)
  list(GET zwang_rival_${NAME} 0 zwang_package)
  if(${zwang_hint})
    set(${zwang_package}_ROOT ${${zwang_hint}})
  endif()
  find_package(${zwang_package} QUIET)
  set(zwang_rival_target)
  foreach(zwang_candidate ${zwang_rival_${NAME}})
    if(NOT zwang_rival_target AND TARGET ${zwang_candidate})
      set(zwang_rival_target ${zwang_candidate})
    endif()
  endforeach()
  if(${zwang_hint} AND NOT zwang_rival_target)
    message(FATAL_ERROR "${zwang_hint}=${${zwang_hint}}: no ${zwang_package} there")
  endif()
endmacro()
