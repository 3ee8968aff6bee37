# pickcell_module(NAME [DEPENDS module...] [PUBLIC lib...] [PRIVATE lib...] [WITHOUT regex])
#
# WITHOUT leaves out the .cpp files whose name matches: what an option switched off.
#
# The one way to declare a module: folder pickcell/NAME becomes the library pickcell::NAME from every .cpp in it and in the
# folders in it, its headers a FILE_SET (so that each header is compiled on its own by all_verify_interface_header_sets), and
# every *_test.cpp the test program NAME_test with the label "unit". PUBLIC libraries are header-only ones that appear in the
# module's headers (Eigen, tl::expected); everything else is PRIVATE: see the table in docs/architecture.md, kept by
# tools/check_includes.py.
# WITHOUT patterns of names leave out the files of options that are off.
function(pickcell_module NAME)
  cmake_parse_arguments(M "" "" "DEPENDS;PUBLIC;PRIVATE;WITHOUT" ${ARGN})
  set(dir ${PROJECT_SOURCE_DIR}/pickcell/${NAME})
  file(GLOB sources CONFIGURE_DEPENDS ${dir}/*.cpp ${dir}/*/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${dir}/*.hpp ${dir}/*/*.hpp)
  list(FILTER headers EXCLUDE REGEX "/[a-z_0-9]*-inl\\.hpp$")  # pieces of .cpp files
  file(GLOB tests CONFIGURE_DEPENDS ${dir}/*_test.cpp ${dir}/*/*_test.cpp)
  if(tests)
    list(REMOVE_ITEM sources ${tests})
  endif()
  foreach(stem IN LISTS M_WITHOUT)
    foreach(list sources headers tests)
      list(FILTER ${list} EXCLUDE REGEX "/(${stem})(_test)?\\.[ch]pp$")
    endforeach()
  endforeach()
  set(target pickcell_${NAME})
  list(TRANSFORM M_DEPENDS PREPEND pickcell::)
  if(NOT sources)  # headers only
    add_library(${target} INTERFACE)
    add_library(pickcell::${NAME} ALIAS ${target})
    target_sources(${target} INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
    target_link_libraries(${target} INTERFACE ${M_DEPENDS} ${M_PUBLIC})
    return()
  endif()
  add_library(${target} STATIC ${sources})
  add_library(pickcell::${NAME} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON LINKER_LANGUAGE CXX)
  target_link_libraries(${target} PUBLIC ${M_DEPENDS} ${M_PUBLIC} PRIVATE ${M_PRIVATE})
  pickcell_warnings(${target})
  pickcell_common_headers(${target})
  if(tests AND PICKCELL_WITH_TESTS)
    pickcell_test(${NAME}_test LABEL unit SOURCES ${tests} LIBS pickcell::${NAME} ${M_PRIVATE})
  endif()
endfunction()

# pickcell_common_headers(TARGET): what nearly every source reads, compiled once for all modules: a quarter of the build's
# time. A source with flags of its own sets SKIP_PRECOMPILE_HEADERS. What a .cpp forgets to include shows in the preset
# release, which goes without; headers are verified without.
function(pickcell_common_headers TARGET)
  if(NOT TARGET pickcell_pch)
    file(WRITE ${CMAKE_BINARY_DIR}/pch.cpp "")
    add_library(pickcell_pch OBJECT ${CMAKE_BINARY_DIR}/pch.cpp)
    target_link_libraries(pickcell_pch PRIVATE pickcell_eigen)
    target_precompile_headers(pickcell_pch PRIVATE <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional>
      <map> <memory> <mutex> <optional> <span> <string> <string_view> <variant> <vector> <tl/expected.hpp> <Eigen/Core>
      <Eigen/Geometry>)
    pickcell_warnings(pickcell_pch)
  endif()
  target_precompile_headers(${TARGET} REUSE_FROM pickcell_pch)
endfunction()

# pickcell_test(NAME LABEL unit|data|... SOURCES file... [LIBS lib...] [TIMEOUT_S n]): a GoogleTest program. Skipped tests are
# reported as skipped by CTest; tests_LABEL builds all programs of a label.
function(pickcell_test NAME)
  cmake_parse_arguments(T "" "LABEL;TIMEOUT_S" "SOURCES;LIBS" ${ARGN})
  if(NOT T_TIMEOUT_S)
    set(T_TIMEOUT_S 300)
  endif()
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    math(EXPR T_TIMEOUT_S "6 * ${T_TIMEOUT_S}")
  endif()
  add_executable(${NAME} ${T_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${T_LIBS} GTest::gmock GTest::gtest_main)
  # One precompiled header for all test programs: they are compiled with the same options.
  if(NOT TARGET pickcell_test_pch)
    file(WRITE ${CMAKE_BINARY_DIR}/test_pch.cpp "")
    add_library(pickcell_test_pch OBJECT ${CMAKE_BINARY_DIR}/test_pch.cpp)
    target_link_libraries(pickcell_test_pch PRIVATE GTest::gmock pickcell_eigen)
    target_precompile_headers(pickcell_test_pch PRIVATE <gtest/gtest.h> <gmock/gmock.h> <Eigen/Core> <Eigen/Geometry>)
    target_compile_definitions(pickcell_test_pch PRIVATE PICKCELL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    pickcell_warnings(pickcell_test_pch)
  endif()
  target_precompile_headers(${NAME} REUSE_FROM pickcell_test_pch)
  target_compile_definitions(${NAME} PRIVATE PICKCELL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  pickcell_warnings(${NAME})
  if(NOT TARGET tests_${T_LABEL})
    add_custom_target(tests_${T_LABEL})  # all programs of one label, for ./check --label
  endif()
  add_dependencies(tests_${T_LABEL} ${NAME})
  set(alone FALSE)
  if(T_LABEL STREQUAL camera)
    set(alone TRUE)  # a camera sends whether anybody has time for it or not
  endif()
  include(GoogleTest)
  # Files of tests stay apart: two builds on one machine would delete each other's journals.
  set(folder ${CMAKE_BINARY_DIR}/tmp/${NAME})
  file(MAKE_DIRECTORY ${folder})
  gtest_discover_tests(${NAME} DISCOVERY_MODE PRE_TEST
    PROPERTIES ENVIRONMENT TEST_TMPDIR=${folder} LABELS ${T_LABEL} TIMEOUT ${T_TIMEOUT_S} RUN_SERIAL ${alone} SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
endfunction()

function(pickcell_warnings TARGET)
  target_compile_options(${TARGET} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Woverloaded-virtual -Wimplicit-fallthrough)
  if(PICKCELL_WARNINGS_AS_ERRORS)
    target_compile_options(${TARGET} PRIVATE -Werror)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13 AND CMAKE_BUILD_TYPE STREQUAL Release)
      # False alarms of GCC 12 at -O3 over "text" + std::string (its bug 105651).
      target_compile_options(${TARGET} PRIVATE -Wno-error=stringop-overflow -Wno-error=restrict)
    endif()
  endif()
endfunction()
