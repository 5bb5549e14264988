# Installs headway into PREFIX, configures and builds SOURCE_DIR against it, and runs the result.
include(${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake)

file(READ ${SOURCE_DIR}/robot.cpp example)
file(READ ${DOCUMENT} document)
string(FIND "${document}" "${example}" place)
if(place EQUAL -1)
  message(FATAL_ERROR "${DOCUMENT} does not show robot.cpp as it is")
endif()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${PREFIX})
run_consumer()
