# MuJoCo: the CMake target of Debian's package names a folder that it does not install.
# Gives MuJoCo::MuJoCo and MuJoCo_VERSION.
find_path(MuJoCo_INCLUDE_DIR mujoco/mujoco.h)
find_library(MuJoCo_LIBRARY mujoco)
mark_as_advanced(MuJoCo_INCLUDE_DIR MuJoCo_LIBRARY)
if(MuJoCo_INCLUDE_DIR)
  # 223 is 2.2.3
  file(STRINGS ${MuJoCo_INCLUDE_DIR}/mujoco/mujoco.h line REGEX "#define mjVERSION_HEADER" LIMIT_COUNT 1)
  string(REGEX REPLACE ".*mjVERSION_HEADER +([0-9]+)([0-9])([0-9]).*" "\\1.\\2.\\3" MuJoCo_VERSION "${line}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR VERSION_VAR MuJoCo_VERSION)
if(MuJoCo_FOUND AND NOT TARGET MuJoCo::MuJoCo)
  add_library(MuJoCo::MuJoCo INTERFACE IMPORTED)
  target_include_directories(MuJoCo::MuJoCo SYSTEM INTERFACE ${MuJoCo_INCLUDE_DIR})
  target_link_libraries(MuJoCo::MuJoCo INTERFACE ${MuJoCo_LIBRARY})
endif()
