# zwang_component(TARGET NAME COMPONENT): a library of the project, linked as zwang::NAME in the tree and installed, whose
# flags stay its own. It is loaded by find_package(zwang COMPONENTS COMPONENT).
function(zwang_component TARGET NAME COMPONENT)
  get_target_property(type ${TARGET} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    target_link_libraries(${TARGET} PRIVATE $<BUILD_INTERFACE:zwang_options>)
  endif()
  set_target_properties(${TARGET} PROPERTIES EXPORT_NAME ${NAME})
  add_library(zwang::${NAME} ALIAS ${TARGET})
  install(TARGETS ${TARGET} EXPORT zwang_${COMPONENT} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
endfunction()

# zwang_headers_of(FOLDER): FOLDER's headers are installed, readable as <zwang/FOLDER/...>.
function(zwang_headers_of FOLDER)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${FOLDER} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/zwang COMPONENT dev
    FILES_MATCHING PATTERN "*.h" PATTERN "*.def" PATTERN node_modules EXCLUDE)
endfunction()

# Installs what find_package(zwang) reads.
function(zwang_install_package)
  include(CMakePackageConfigHelpers)
  set(place ${CMAKE_INSTALL_LIBDIR}/cmake/zwang)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/core/cmake/zwangConfig.cmake.in
    ${PROJECT_BINARY_DIR}/zwangConfig.cmake INSTALL_DESTINATION ${place})
  # No promise between 0.2 and 0.3.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/zwangConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  file(GLOB modules CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/core/cmake/Find*.cmake ${PROJECT_SOURCE_DIR}/core/cmake/rivals.cmake)
  install(FILES ${PROJECT_BINARY_DIR}/zwangConfig.cmake ${PROJECT_BINARY_DIR}/zwangConfigVersion.cmake
    ${modules}
    DESTINATION ${place} COMPONENT dev)
  foreach(component core constraints solvers collision bench god_hand)
    install(EXPORT zwang_${component} FILE zwang_${component}.cmake NAMESPACE zwang:: DESTINATION ${place} COMPONENT dev)
  endforeach()
endfunction()
