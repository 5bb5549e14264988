# SPDX-License-Identifier: BSD-3-Clause
# Installs headway into PREFIX, configures and builds SOURCE_DIR and README's example against it, and runs them.
include(${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake)

file(READ ${DOCUMENT} document)
foreach(program IN ITEMS robot planner)
  file(READ ${SOURCE_DIR}/${program}.cpp example)
  string(REGEX REPLACE "^// SPDX[^\n]*\n" "" example "${example}")
  string(FIND "${document}" "${example}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${DOCUMENT} does not show ${program}.cpp as it is")
  endif()
endforeach()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${PREFIX})
run_consumer()

# README.md's CMakeLists.txt and program, as they are written there.
function(write_code_block document language file)
  file(READ ${document} text)
  if(NOT text MATCHES "\n```${language}\n([^`]*)```")
    message(FATAL_ERROR "${document} has no block of ${language}")
  endif()
  file(WRITE ${file} "${CMAKE_MATCH_1}")
endfunction()
set(readme ${WORK_DIR}/readme)
write_code_block(${README} cmake ${readme}/CMakeLists.txt)
write_code_block(${README} cpp ${readme}/robot.cpp)
build_consumer(${readme} ${readme}/build)
run(${CMAKE_COMMAND} -E copy ${RAWLOG} ${readme}/mine.rawlog)
execute_process(COMMAND ${readme}/build/robot WORKING_DIRECTORY ${readme} RESULT_VARIABLE status OUTPUT_VARIABLE said)
if(status OR NOT said MATCHES "track [0-9]+ will be at -?[0-9]")
  message(FATAL_ERROR "README's program failed (${status}):\n${said}")
endif()
