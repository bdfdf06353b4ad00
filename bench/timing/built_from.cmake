# Run at every build: writes OUTPUT with the commit of SOURCE_DIR when it changed. The caller passes what the
# configuration knows: VERSION COMPILER FLAGS BUILD_TYPE LIBRARIES.
cmake_minimum_required(VERSION 3.25)
set(commit unknown)
set(dirty false)
execute_process(COMMAND git rev-parse HEAD WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE found
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(NOT failed)
  set(commit ${found})
  execute_process(COMMAND git status --porcelain --untracked-files=no WORKING_DIRECTORY ${SOURCE_DIR}
                  OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    set(dirty true)
  endif()
endif()
string(STRIP "${FLAGS}" FLAGS)
string(REGEX REPLACE " +" " " FLAGS "${FLAGS}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#pragma once
#define ZWANG_VERSION "@VERSION@"
#define ZWANG_COMMIT "@commit@"
#define ZWANG_DIRTY @dirty@
#define ZWANG_COMPILER "@COMPILER@"
#define ZWANG_FLAGS "@FLAGS@"
#define ZWANG_BUILD_TYPE "@BUILD_TYPE@"
#define ZWANG_LIBRARIES "@LIBRARIES@"
]] @ONLY)
