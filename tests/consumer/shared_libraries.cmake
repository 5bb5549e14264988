# SPDX-License-Identifier: BSD-3-Clause
# Builds headway as shared libraries without simulator, evaluation and trials, installs it, runs an
# installed program, and builds SOURCE_DIR against it.
include(${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake)

set(PREFIX ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -G Ninja -S ${HEADWAY_DIR} -B ${WORK_DIR}/headway -DCMAKE_BUILD_TYPE=Release
    -DBUILD_SHARED_LIBS=ON -DHEADWAY_BUILD_LIVE=OFF -DHEADWAY_BUILD_SIM=OFF -DHEADWAY_BUILD_EVAL=OFF
    -DHEADWAY_BUILD_NAV_TRIALS=OFF -DHEADWAY_BUILD_TESTS=OFF)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/headway)
run(${CMAKE_COMMAND} --install ${WORK_DIR}/headway --prefix ${PREFIX})
run(${PREFIX}/bin/headway-replay --version)
foreach(program IN ITEMS headway-sim headway-eval headway-nav)
  if(EXISTS ${PREFIX}/bin/${program})
    message(FATAL_ERROR "${program} was built though its option is off")
  endif()
endforeach()
file(GLOB pipeline ${PREFIX}/lib*/libheadway_pipeline.so.*.*.* ${PREFIX}/lib*/*/libheadway_pipeline.so.*.*.*)
if(NOT pipeline)
  message(FATAL_ERROR "libheadway_pipeline.so carries no version")
endif()
set(WORK_DIR ${WORK_DIR}/consumer)
run_consumer()
