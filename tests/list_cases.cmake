# Writes OUTPUT, which registers every case of the GoogleTest program PROGRAM with ctest as "NAME.Suite.Case", in the
# words of GoogleTest's own names. gtest_discover_tests would add what the program prints about parameters: for a named
# type all of "# TypeParam = ...", for a struct its bytes, which differ from run to run. Suites named "...Slow" get the
# label slow.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed TIMEOUT 60 COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE " +#[^\n]*" "" listed "${listed}")
string(REGEX MATCHALL "[^\n]+" lines "${listed}")
set(script "")
foreach(line ${lines})
  if(line MATCHES "^([^ ]+)\\.$")
    set(suite ${CMAKE_MATCH_1})
  elseif(line MATCHES "^  ([^ ]+)$")
    set(case ${suite}.${CMAKE_MATCH_1})
    set(labels "")
    if(suite MATCHES "Slow$")
      set(labels "LABELS slow TIMEOUT 1800")
    endif()
    string(APPEND script "add_test([==[${NAME}.${case}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${case}]==])\n"
      "set_tests_properties([==[${NAME}.${case}]==] PROPERTIES RUN_SERIAL ${ALONE} ${labels} SKIP_REGULAR_EXPRESSION [==[\\[  SKIPPED \\]]==])\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "${script}")
