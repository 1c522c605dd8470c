# rigcal_library(NAME [SHAREABLE] SOURCES a.cc ... DEPS rigcal_base ... [PCH <header> ...])   PCH: beyond the headers that all share
#   SHAREABLE: may become part of a shared library (librigcal)
# rigcal_program(NAME SOURCES ... DEPS ...)
# rigcal_manpage(NAME SECTION)                          build/.../man/NAME.SECTION.gz, from its --help
# rigcal_test(NAME [COMPUTES] [WHOLE] SOURCES ... DEPS ... [LABELS ...])   one GoogleTest program, one ctest per case
#   COMPUTES: spends its time in templates of its own (Eigen, simulation), so it is optimised as the product is
#   WHOLE: its cases judge one thing that costs much to make: one ctest for all of them
# rigcal_embed(TARGET NAMESPACE ns FILES ...)             files as string_view constants: "<ns>/embedded.h"
# rigcal_embed_built(TARGET NAMESPACE ns OUTPUT x.h FILES ...)  the same for large files that the build makes

find_program(CCACHE ccache)
if(CCACHE)
  # The sloppiness lets it cache files that use a precompiled header.
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

set(RIGCAL_WARNINGS -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Guesses of GCC 12's optimiser that are wrong inside the standard library and Eigen; clang-tidy looks at these instead.
  list(APPEND RIGCAL_WARNINGS -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
       -Wno-restrict -Wno-dangling-pointer)
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Collecting its own garbage is a sixth of the compiler's time in files that use Eigen; 2 GB a process go without.
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=2000000>")
endif()

if(RIGCAL_SANITIZE)
  add_compile_options(-fsanitize=${RIGCAL_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${RIGCAL_SANITIZE})
endif()

if(RIGCAL_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,float-cast-overflow -fno-sanitize-recover=all)
endif()

# What nearly every file includes. `dev` and `tidy` do without, so that a file still has to include what it uses.
set(RIGCAL_PCH_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <cstdio> <filesystem> <fstream> <functional>
    <limits> <map> <memory> <numeric> <optional> <random> <set> <span> <sstream> <string> <string_view> <unordered_map>
    <utility> <vector> <Eigen/Dense> <tl/expected.hpp>)
option(RIGCAL_PCH "Precompile headers" ON)
if(RIGCAL_TIDY OR RIGCAL_FUZZ)
  set(RIGCAL_PCH OFF)
endif()

function(rigcal_settings target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${RIGCAL_WARNINGS}>)
  if(RIGCAL_TIDY)
    set_target_properties(${target} PROPERTIES CXX_CLANG_TIDY "clang-tidy;--quiet")
  endif()
endfunction()

# rigcal_unite(TARGET [FOLDERS])   compiles eight of its files as one: headers and templates once. What a file keeps to itself
# then needs a name that no other file of the target has, nor a header of another. FOLDERS: the files of each folder as
# one, so that names have to differ within a folder only. detect, graph, cloud and sim, whose speed is measured, are
# compiled file by file; of test programs those that have many files are united.
option(RIGCAL_UNITY "Compile several files as one" ON)
function(rigcal_unite target)
  cmake_parse_arguments(arg "FOLDERS" "" "" ${ARGN})
  if(NOT RIGCAL_UNITY OR RIGCAL_TIDY OR RIGCAL_FUZZ)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  if(arg_FOLDERS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${target} SOURCES)
    foreach(source ${sources})
      get_filename_component(folder ${source} DIRECTORY)
      string(MAKE_C_IDENTIFIER "${folder}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endforeach()
  endif()
endfunction()

# rigcal_precompile(TARGET FROM owner)            uses the precompiled header of `owner`, which has the same flags
# rigcal_precompile(TARGET HEADERS <header> ...)  has its own
function(rigcal_precompile target)
  cmake_parse_arguments(arg "" "FROM" "HEADERS" ${ARGN})
  if(NOT RIGCAL_PCH)
    return()
  endif()
  if(arg_FROM)
    target_precompile_headers(${target} REUSE_FROM ${arg_FROM})
  else()
    target_precompile_headers(${target} PRIVATE ${arg_HEADERS})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # or ccache cannot see into it
  endif()
endfunction()

# Code that runs wherever it is loaded, and calls its own functions as directly as other code does.
function(rigcal_shareable target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -fno-semantic-interposition)
endfunction()

# An owner of a precompiled header that many targets share: RIGCAL_PCH_HEADERS and those named.
function(rigcal_precompiled name)
  cmake_parse_arguments(arg "SHAREABLE" "" "HEADERS;OPTIONS;DEPS" ${ARGN})
  if(RIGCAL_PCH)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${name}.cc CONTENT "" @ONLY)
    add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cc)
    target_link_libraries(${name} PRIVATE Eigen3::Eigen ${arg_DEPS})
    rigcal_settings(${name})
    rigcal_precompile(${name} HEADERS ${RIGCAL_PCH_HEADERS} ${arg_HEADERS})
    target_compile_options(${name} PRIVATE ${arg_OPTIONS})
    if(arg_SHAREABLE)
      rigcal_shareable(${name})
    endif()
  endif()
endfunction()

rigcal_precompiled(rigcal_pch)
rigcal_precompiled(rigcal_shareable_pch SHAREABLE)

function(rigcal_library name)
  cmake_parse_arguments(arg "SHAREABLE" "" "SOURCES;DEPS;PCH" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  target_link_libraries(${name} PUBLIC ${arg_DEPS})
  rigcal_settings(${name})
  if(arg_SHAREABLE)
    rigcal_shareable(${name})
  endif()
  if(arg_PCH)
    rigcal_precompile(${name} HEADERS ${RIGCAL_PCH_HEADERS} ${arg_PCH})
  elseif(arg_SHAREABLE)
    rigcal_precompile(${name} FROM rigcal_shareable_pch)
  else()
    rigcal_precompile(${name} FROM rigcal_pch)
  endif()
endfunction()

function(rigcal_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_DEPS})
  rigcal_settings(${name})
  rigcal_precompile(${name} FROM rigcal_pch)
endfunction()

function(rigcal_manpage name section)
  set(script ${PROJECT_SOURCE_DIR}/deploy/packaging/manpage.py)
  set_property(TARGET ${name} APPEND PROPERTY LINK_DEPENDS ${script})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${Python3_EXECUTABLE} -B ${script} $<TARGET_FILE:${name}> ${section} ${PROJECT_VERSION}
            ${PROJECT_BINARY_DIR}/man/${name}.${section}.gz
    BYPRODUCTS ${PROJECT_BINARY_DIR}/man/${name}.${section}.gz VERBATIM)
endfunction()

function(rigcal_test name)
  cmake_parse_arguments(arg "COMPUTES;WHOLE" "" "SOURCES;DEPS;LABELS" ${ARGN})
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_DEPS} GTest::gmock_main)
  rigcal_settings(${name})
  if(arg_COMPUTES)
    rigcal_precompile(${name} FROM rigcal_computing_test_pch)
  else()
    rigcal_precompile(${name} FROM rigcal_test_pch)
    target_compile_options(${name} PRIVATE ${RIGCAL_TEST_OPTIONS})
  endif()
  target_compile_definitions(${name} PRIVATE RIGCAL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(arg_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 300 ENVIRONMENT "RIGCAL_DDS_LOCAL=1" LABELS "${arg_LABELS}" COST 20)
  else()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300 ENVIRONMENT "RIGCAL_DDS_LOCAL=1"
                          LABELS "${arg_LABELS}")
  endif()
endfunction()

function(rigcal_embed target)
  cmake_parse_arguments(arg "" "NAMESPACE;OUTPUT" "FILES" ${ARGN})
  set(header ${CMAKE_CURRENT_BINARY_DIR}/embedded/${arg_OUTPUT})
  set(paths "")
  foreach(file ${arg_FILES})
    list(APPEND paths ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${header} -DNAMESPACE=${arg_NAMESPACE} "-DFILES=${paths}"
            -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${paths} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/embedded)
endfunction()

# By the assembler's .incbin: megabytes cost the compiler nothing.
function(rigcal_embed_built target)
  cmake_parse_arguments(arg "" "NAMESPACE;OUTPUT" "FILES" ${ARGN})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(declarations "")
  set(table "")
  set(assembly "    .section .rodata\n")
  foreach(path ${arg_FILES})
    get_filename_component(name ${path} NAME)
    string(MAKE_C_IDENTIFIER "rigcal_built_${name}" symbol)
    string(APPEND assembly "    .global ${symbol}\n${symbol}:\n    .incbin \"${path}\"\n")
    string(APPEND assembly "    .global ${symbol}_end\n${symbol}_end:\n    .byte 0\n")
    string(APPEND declarations "extern \"C\" const char ${symbol}[];\nextern \"C\" const char ${symbol}_end[];\n")
    string(APPEND table
           "  {\"${name}\", {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})}},\n")
  endforeach()
  string(APPEND assembly "    .section .note.GNU-stack,\"\",%progbits\n")
  list(LENGTH arg_FILES count)
  file(CONFIGURE OUTPUT ${folder}/${arg_OUTPUT} @ONLY CONTENT
"#pragma once
#include <array>
#include <string_view>
#include <utility>
${declarations}namespace ${arg_NAMESPACE} {
inline const std::array<std::pair<std::string_view, std::string_view>, ${count}> kBuiltFiles = {{
${table}}};
}
")
  file(CONFIGURE OUTPUT ${folder}/${arg_OUTPUT}.S @ONLY CONTENT "${assembly}")
  set_source_files_properties(${folder}/${arg_OUTPUT}.S PROPERTIES OBJECT_DEPENDS "${arg_FILES}")
  target_sources(${target} PRIVATE ${folder}/${arg_OUTPUT}.S)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
