# How headway declares libraries, programs and tests. Three functions, so that every
# CMakeLists.txt below libs/, apps/ and tests/ is a list of sources and of what they need.
include(CMakePackageConfigHelpers)

set(HEADWAY_SANITIZE "" CACHE STRING "Sanitizers to build with, as given to -fsanitize=")
set_property(GLOBAL PROPERTY HEADWAY_FOUND_PACKAGES "")
set_property(GLOBAL PROPERTY HEADWAY_FOUND_MODULES "")

add_library(headway_warnings INTERFACE)
target_compile_options(headway_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                  -Wno-sign-conversion)
if(HEADWAY_SANITIZE)
  add_compile_options(-fsanitize=${HEADWAY_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HEADWAY_SANITIZE})
endif()

# headway_find(<package> [COMPONENTS ...]): find_package() that installed consumers repeat.
macro(headway_find package)
  find_package(${package} REQUIRED ${ARGN})
  string(REPLACE ";" " " _headway_arguments "${ARGN}")
  set_property(GLOBAL APPEND PROPERTY HEADWAY_FOUND_PACKAGES "${package} ${_headway_arguments}")
endmacro()

# headway_find_pkg(<name> <module> ...): target PkgConfig::<name> of what pkg-config knows, for
# installed consumers as well.
macro(headway_find_pkg name)
  headway_find(PkgConfig)
  pkg_check_modules(${name} REQUIRED IMPORTED_TARGET GLOBAL ${ARGN})
  string(REPLACE ";" " " _headway_modules "${ARGN}")
  set_property(GLOBAL APPEND PROPERTY HEADWAY_FOUND_MODULES "${name} REQUIRED IMPORTED_TARGET GLOBAL ${_headway_modules}")
endmacro()

# headway_library(<name> SOURCES ... [PUBLIC ...] [PRIVATE ...]): target headway::<name> whose
# public headers are libs/<name>/include/headway/<name>/*.h.
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
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT headwayTargets)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# headway_program(<name> SOURCES ... LIBRARIES ...): an installed command-line program.
function(headway_program name)
  cmake_parse_arguments(PROGRAM "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${PROGRAM_SOURCES})
  target_link_libraries(${name} PRIVATE ${PROGRAM_LIBRARIES} headway_program headway_warnings)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${name})
endfunction()

# headway_test(<name> SOURCES ... LIBRARIES ... [LABELS ...] [PRIVATE_HEADERS <library>]):
# one GoogleTest program, each of its tests known to ctest. A test that needs real data says
# GTEST_SKIP() where the environment variable HEADWAY_DATA names no folder.
function(headway_test name)
  cmake_parse_arguments(TEST "" "TIMEOUT;PRIVATE_HEADERS" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  set(target test_${name})
  add_executable(${target} ${TEST_SOURCES})
  target_link_libraries(${target} PRIVATE ${TEST_LIBRARIES} headway_test_support
                        GTest::gmock GTest::gtest_main headway_warnings)
  if(TEST_PRIVATE_HEADERS)
    target_include_directories(${target} PRIVATE
                               ${PROJECT_SOURCE_DIR}/libs/${TEST_PRIVATE_HEADERS}/src)
  endif()
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 120)
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
  gtest_discover_tests(${target} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${TEST_TIMEOUT} LABELS "${TEST_LABELS}")
endfunction()

# Installs the exported targets and headwayConfig.cmake.
function(headway_install_package)
  get_property(packages GLOBAL PROPERTY HEADWAY_FOUND_PACKAGES)
  list(REMOVE_DUPLICATES packages)
  set(HEADWAY_DEPENDENCIES "")
  foreach(package IN LISTS packages)
    string(APPEND HEADWAY_DEPENDENCIES "find_dependency(${package})\n")
  endforeach()
  get_property(modules GLOBAL PROPERTY HEADWAY_FOUND_MODULES)
  foreach(module IN LISTS modules)
    string(APPEND HEADWAY_DEPENDENCIES "pkg_check_modules(${module})\n")
  endforeach()
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/headway)
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/libs/cmake/headwayConfig.cmake.in
    ${PROJECT_BINARY_DIR}/headwayConfig.cmake INSTALL_DESTINATION ${destination})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/headwayConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/headwayConfig.cmake
                ${PROJECT_BINARY_DIR}/headwayConfigVersion.cmake DESTINATION ${destination})
  install(EXPORT headwayTargets NAMESPACE headway:: DESTINATION ${destination})
endfunction()
