# The certificate of references shares no code with a solver: neither it nor anything it includes of the project,
# directly or not, lies in solvers/. Run: cmake -DSOURCE_DIR=... -P certificate_stands_alone.cmake
cmake_minimum_required(VERSION 3.25)
include(${SOURCE_DIR}/bench/references/included_sources.cmake)
included_sources(found bench/references/kkt_certificate.h)
foreach(file ${found})
  if(file MATCHES "^solvers/")
    message(SEND_ERROR "the certificate depends on ${file}")
  endif()
endforeach()
list(LENGTH found count)
if(count LESS 4)
  message(SEND_ERROR "only ${count} files were looked at: ${found}")
endif()
