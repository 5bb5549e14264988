# SPDX-License-Identifier: BSD-3-Clause
# How headway declares libraries, programs and tests. Three functions, so that every
# CMakeLists.txt below libs/, apps/ and tests/ is a list of sources and of what they need.
include(CMakePackageConfigHelpers)

set(HEADWAY_REGISTER_SUITES ${CMAKE_CURRENT_LIST_DIR}/RegisterSuites.cmake)
set(HEADWAY_SANITIZE "" CACHE STRING "Sanitizers to build with, as given to -fsanitize=")
set_property(GLOBAL PROPERTY HEADWAY_LIBRARIES "")
set(HEADWAY_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/headway)

add_custom_target(installed)  # all that `cmake --install` installs, without the tests
add_library(headway_warnings INTERFACE)
target_compile_options(headway_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                  -Wno-sign-conversion)
if(HEADWAY_SANITIZE)
  add_compile_options(-fsanitize=${HEADWAY_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HEADWAY_SANITIZE})
  if(HEADWAY_SANITIZE MATCHES undefined AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    add_compile_options(-fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/tests/sanitizers/library_headers.txt)
  endif()
else()
  # Hardened: overflows of the stack and of buffers of known size end a program, and its tables of
  # addresses are read-only. Debug builds check every access to a container too.
  add_compile_options(-fstack-protector-strong)
  add_compile_definitions($<IF:$<CONFIG:Debug>,_GLIBCXX_ASSERTIONS,_FORTIFY_SOURCE=2>)
  add_link_options(-Wl,-z,relro,-z,now)
  include(CheckPIESupported)
  check_pie_supported()
endif()

# headway_find(<package> [PRIVATE] [COMPONENTS ...]): find_package() for the library that this
# CMakeLists.txt declares; whoever uses the installed library repeats it. PRIVATE: no public header
# needs the package, so users of a shared library do not.
macro(headway_find package)
  cmake_parse_arguments(_headway_find "PRIVATE" "" "" ${ARGN})
  find_package(${package} REQUIRED ${_headway_find_UNPARSED_ARGUMENTS})
  if(NOT (_headway_find_PRIVATE AND BUILD_SHARED_LIBS))
    string(REPLACE ";" " " _headway_arguments "${_headway_find_UNPARSED_ARGUMENTS}")
    string(APPEND _headway_dependencies "find_dependency(${package} ${_headway_arguments})\n")
  endif()
endmacro()

# headway_find_pkg(<name> <module> ...): target PkgConfig::<name> of what pkg-config knows, needed
# by no public header.
macro(headway_find_pkg name)
  headway_find(PkgConfig PRIVATE)
  pkg_check_modules(${name} REQUIRED IMPORTED_TARGET GLOBAL ${ARGN})
  if(NOT BUILD_SHARED_LIBS)
    string(REPLACE ";" " " _headway_modules "${ARGN}")
    string(APPEND _headway_dependencies
           "pkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${_headway_modules})\n")
  endif()
endmacro()

# headway_find_optional_pkg(<name> <module>), headway_find_optional(<package> <target> <name>): what
# a library can do without. HEADWAY_OPTIONAL lists the targets of what was found, and
# HEADWAY_OPTIONAL_DEFINITIONS has HEADWAY_HAS_<name>=1 or 0.
macro(headway_find_optional_pkg name module)
  headway_find(PkgConfig PRIVATE)
  pkg_check_modules(${name} QUIET IMPORTED_TARGET GLOBAL ${module})
  headway_use_optional(${name} ${name}_FOUND PkgConfig::${name})
  if(${name}_FOUND AND NOT BUILD_SHARED_LIBS)
    string(APPEND _headway_dependencies
           "pkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${module})\n")
  endif()
endmacro()

macro(headway_find_optional package target name)
  find_package(${package} QUIET)
  headway_use_optional(${name} ${package}_FOUND ${target})
  if(${package}_FOUND AND NOT BUILD_SHARED_LIBS)
    string(APPEND _headway_dependencies "find_dependency(${package})\n")
  endif()
endmacro()

macro(headway_use_optional name found target)
  if(${found})
    list(APPEND HEADWAY_OPTIONAL ${target})
    list(APPEND HEADWAY_OPTIONAL_DEFINITIONS HEADWAY_HAS_${name}=1)
  else()
    message(STATUS "${name} was not found: what needs it is left out")
    list(APPEND HEADWAY_OPTIONAL_DEFINITIONS HEADWAY_HAS_${name}=0)
  endif()
endmacro()

# headway_library(<name> SOURCES ... [PUBLIC ...] [PRIVATE ...]): target headway::<name> whose
# public headers are libs/<group>/<name>/include/headway/<name>/*.h.
# Third-party headers count as system headers, so only our own code is held to the warnings.
function(headway_library name)
  cmake_parse_arguments(LIBRARY "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target headway_${name})
  add_library(${target} ${LIBRARY_SOURCES})
  add_library(headway::${name} ALIAS ${target})
  target_include_directories(
    ${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${LIBRARY_PUBLIC}
                        PRIVATE ${LIBRARY_PRIVATE} $<BUILD_INTERFACE:headway_warnings>)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # Without DEFINE_SYMBOL the objects of static and shared builds are the same.
  set_target_properties(
    ${target}
    PROPERTIES EXPORT_NAME ${name} DEFINE_SYMBOL "" INSTALL_RPATH "$ORIGIN"
               VERSION ${PROJECT_VERSION}
               SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  headway_compile_in_batches(${target})
  if(BUILD_SHARED_LIBS AND NOT HEADWAY_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
  install(TARGETS ${target} EXPORT headway-${name}-targets)
  add_dependencies(installed ${target})
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  headway_export(${name} ${LIBRARY_PUBLIC} ${LIBRARY_PRIVATE})
endfunction()

# Installs headway-<name>.cmake: what the library needs, then its target.
function(headway_export name)
  set(HEADWAY_LIBRARY ${name})
  set(HEADWAY_LIBRARIES_NEEDED ${ARGN})
  list(FILTER HEADWAY_LIBRARIES_NEEDED INCLUDE REGEX "^headway::")
  string(REPLACE "headway::" "" HEADWAY_LIBRARIES_NEEDED "${HEADWAY_LIBRARIES_NEEDED}")
  set(HEADWAY_DEPENDENCIES "${_headway_dependencies}")
  configure_file(${PROJECT_SOURCE_DIR}/libs/cmake/headway-library.cmake.in headway-${name}.cmake
                 @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/headway-${name}.cmake
          DESTINATION ${HEADWAY_PACKAGE_DIR})
  install(EXPORT headway-${name}-targets NAMESPACE headway:: DESTINATION ${HEADWAY_PACKAGE_DIR})
  set_property(GLOBAL APPEND PROPERTY HEADWAY_LIBRARIES ${name})
endfunction()

# Compiles sixteen sources at once, because the headers of MRPT, OpenCV and Eigen take most of a single one's time: what
# a file keeps to itself has its own name within the target. CMAKE_UNITY_BUILD_BATCH_SIZE sets another number.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16 CACHE STRING "Sources of a target that are compiled at once")
function(headway_compile_in_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  # A batch includes its sources, so their own local types look like a header's.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# headway_program(<name> SOURCES ... LIBRARIES ...): an installed command-line program.
function(headway_program name)
  cmake_parse_arguments(PROGRAM "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${PROGRAM_SOURCES})
  target_link_libraries(${name} PRIVATE ${PROGRAM_LIBRARIES} headway_program headway_warnings)
  headway_compile_in_batches(${name})
  file(RELATIVE_PATH libraries /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin
                                           INSTALL_RPATH "$ORIGIN/${libraries}")
  install(TARGETS ${name})
  add_dependencies(installed ${name})
endfunction()

# headway_private_headers(<target> <library> ...): lets the target include the private headers of libraries.
function(headway_private_headers target)
  foreach(library IN LISTS ARGN)
    get_target_property(folder headway_${library} SOURCE_DIR)
    target_include_directories(${target} PRIVATE ${folder}/src)
  endforeach()
endfunction()

# headway_test(<name> SOURCES ... LIBRARIES ... [LABELS ...] [SLOW ...] [NIGHTLY ...] [PRIVATE_HEADERS <library>]):
# one GoogleTest program, each of its suites known to ctest. A test that needs real data says
# GTEST_SKIP() where the environment variable HEADWAY_DATA names no folder. SLOW names what takes
# more than 5 s on an idle core, as <Suite>.<Test> or <Suite>.*: an entry with the label `slow`; NIGHTLY what is left to
# `./test.sh -L nightly`.
function(headway_test name)
  cmake_parse_arguments(TEST "" "TIMEOUT;PRIVATE_HEADERS" "SOURCES;LIBRARIES;LABELS;SLOW;NIGHTLY" ${ARGN})
  set(target test_${name})
  add_executable(${target} ${TEST_SOURCES})
  target_link_libraries(${target} PRIVATE ${TEST_LIBRARIES} headway_test_support
                        GTest::gmock GTest::gtest_main headway_warnings)
  headway_compile_test_quickly(${target})
  target_precompile_headers(${target} REUSE_FROM headway_test_precompiled)
  headway_compile_in_batches(${target})
  if(TEST_PRIVATE_HEADERS)
    headway_private_headers(${target} ${TEST_PRIVATE_HEADERS})
  endif()
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 300)
  endif()
  if(HEADWAY_SANITIZE)
    math(EXPR TEST_TIMEOUT "5 * ${TEST_TIMEOUT}")
  endif()
  if(NOT TEST_LABELS)
    set(TEST_LABELS unit)
  endif()
  if("unit" IN_LIST TEST_LABELS)
    add_dependencies(unit_tests ${target})
  endif()
  headway_register_suites(${target} ${name} ${TEST_TIMEOUT} "${TEST_LABELS}" "${TEST_SLOW}" "${TEST_NIGHTLY}")
endfunction()

# A test's own code takes up to a third less time to compile with -O1 than with Release's -O3, and as much less without
# the checks of each access through a pointer, of which AddressSanitizer finds the wrong ones too. What it tests is in
# libraries, which are as they are installed, and checked whole.
function(headway_compile_test_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(HEADWAY_SANITIZE MATCHES undefined)
    target_compile_options(${target} PRIVATE -fno-sanitize=null,alignment,vptr,object-size)
  endif()
endfunction()

# The ctest entries of a test program; see RegisterSuites.cmake.
function(headway_register_suites target name timeout labels slow nightly)
  set(entries ${CMAKE_CURRENT_BINARY_DIR}/${target}_entries.cmake)
  set(together OFF)
  if(HEADWAY_SANITIZE MATCHES address)
    set(together ON)
  endif()
  add_custom_command(
    TARGET ${target} POST_BUILD BYPRODUCTS ${entries}
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${target}> -DNAME=${name} -DOUTPUT=${entries}
            -DTIMEOUT=${timeout} "-DLABELS=${labels}" "-DSLOW=${slow}" "-DNIGHTLY=${nightly}"
            "-DWITH_NIGHTLY=${HEADWAY_NIGHTLY_TESTS}" -DTOGETHER=${together}
            -P ${HEADWAY_REGISTER_SUITES}
    VERBATIM)
  set_target_properties(${target} PROPERTIES LINK_DEPENDS ${HEADWAY_REGISTER_SUITES})
  set(include ${CMAKE_CURRENT_BINARY_DIR}/${target}_include.cmake)
  file(WRITE ${include} "if(EXISTS [=[${entries}]=])\n  include([=[${entries}]=])\nelse()\n"
       "  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
endfunction()

# Installs headwayConfig.cmake, whose components are the libraries.
function(headway_install_package)
  get_property(HEADWAY_LIBRARIES GLOBAL PROPERTY HEADWAY_LIBRARIES)
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/libs/cmake/headwayConfig.cmake.in
    ${PROJECT_BINARY_DIR}/headwayConfig.cmake INSTALL_DESTINATION ${HEADWAY_PACKAGE_DIR})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/headwayConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/headwayConfig.cmake
                ${PROJECT_BINARY_DIR}/headwayConfigVersion.cmake
          DESTINATION ${HEADWAY_PACKAGE_DIR})
endfunction()
