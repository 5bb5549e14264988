# SPDX-License-Identifier: BSD-3-Clause
# Run after a test program was built: asks it for its tests and writes the ctest entries.
#
# One entry a suite, <NAME>.<Suite>, rather than one a test: the start of a process costs more than most tests.
# What SLOW names, as <Suite>.<Test> or <Suite>.*, has an entry of its own with the label `slow`; those begin first, so
# that none is left over at the end when all else is done.
#
# What NIGHTLY names in the same way is listed with WITH_NIGHTLY alone, with the label `nightly`.
#
# With TOGETHER, all other suites are one entry, <NAME>.others: under AddressSanitizer the start of a process takes a
# second.
#
# -DPROGRAM=... -DNAME=... -DOUTPUT=... -DTIMEOUT=... -DLABELS=... -DSLOW=... -DNIGHTLY=... -DWITH_NIGHTLY=...
# -DTOGETHER=...
cmake_minimum_required(VERSION 3.18)
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listing RESULT_VARIABLE status)
if(status)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${status}")
endif()
string(REGEX REPLACE " *#[^\n]*" "" listing "${listing}")
string(REPLACE "\n" ";" lines "${listing}")

set(script "")
function(entry name filter labels)
  string(APPEND script "add_test([=[${NAME}.${name}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${filter}]=])\n"
         "set_tests_properties([=[${NAME}.${name}]=] PROPERTIES TIMEOUT ${TIMEOUT} LABELS [=[${labels}]=])\n")
  if("slow" IN_LIST labels OR name STREQUAL "others")
    string(APPEND script "set_tests_properties([=[${NAME}.${name}]=] PROPERTIES COST 60)\n")
  endif()
  set(script "${script}" PARENT_SCOPE)
endfunction()

set(suites "")
foreach(line IN LISTS lines)
  if(line MATCHES "^([A-Za-z0-9_/]+)\\.$")
    set(suite ${CMAKE_MATCH_1})
    list(APPEND suites ${suite})
    set(tests_${suite} "")
  elseif(line MATCHES "^  ([A-Za-z0-9_/]+)$")
    list(APPEND tests_${suite} ${suite}.${CMAKE_MATCH_1})
  endif()
endforeach()
if(NOT suites)
  message(FATAL_ERROR "${PROGRAM} lists no tests")
endif()

set(unknown ${SLOW} ${NIGHTLY})

# Which of a suite's tests a list names.
function(named_tests suite list named)
  set(result "")
  foreach(test IN LISTS tests_${suite})
    if(test IN_LIST ${list} OR "${suite}.*" IN_LIST ${list})
      list(APPEND result ${test})
    endif()
  endforeach()
  set(${named} "${result}" PARENT_SCOPE)
  list(REMOVE_ITEM unknown ${result} "${suite}.*")
  set(unknown "${unknown}" PARENT_SCOPE)
endfunction()

# The filter of a suite's tests but for those that further arguments name.
function(filter_of suite filter)
  set(result "${suite}.*")
  if(ARGN)
    string(REPLACE ";" ":" excluded "${ARGN}")
    string(APPEND result "-${excluded}")
  endif()
  set(${filter} "${result}" PARENT_SCOPE)
endfunction()

if(TOGETHER)
  string(REPLACE ";" ":" excluded "${SLOW};${NIGHTLY}")
  entry(others "*-${excluded}" "${LABELS}")
endif()
foreach(suite IN LISTS suites)
  named_tests(${suite} NIGHTLY nightly)
  if(WITH_NIGHTLY)
    foreach(test IN LISTS nightly)
      entry(${test} "${test}" "${LABELS};slow;nightly")
    endforeach()
  endif()
  set(rest ${tests_${suite}})
  list(REMOVE_ITEM rest ${nightly} "")
  if(rest AND "${suite}.*" IN_LIST SLOW)
    filter_of(${suite} filter ${nightly})
    entry(${suite} "${filter}" "${LABELS};slow")
    continue()
  endif()
  named_tests(${suite} SLOW slow)
  foreach(test IN LISTS slow)
    entry(${test} "${test}" "${LABELS};slow")
  endforeach()
  list(REMOVE_ITEM rest ${slow} "")
  if(rest AND NOT TOGETHER)
    filter_of(${suite} filter ${slow} ${nightly})
    entry(${suite} "${filter}" "${LABELS}")
  endif()
endforeach()
if(unknown)
  message(FATAL_ERROR "${NAME}: SLOW or NIGHTLY names no tests: ${unknown}")
endif()
file(WRITE ${OUTPUT} "${script}")
