# SPDX-License-Identifier: BSD-3-Clause
# Installs headway into PREFIX, configures and builds SOURCE_DIR against it, and runs the result.
include(${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake)

file(READ ${DOCUMENT} document)
foreach(program IN ITEMS follow robot planner)
  file(READ ${SOURCE_DIR}/${program}.cpp example)
  string(REGEX REPLACE "^// SPDX[^\n]*\n" "" example "${example}")
  string(FIND "${document}" "${example}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${DOCUMENT} does not show ${program}.cpp as it is")
  endif()
endforeach()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${PREFIX})
run_consumer()
