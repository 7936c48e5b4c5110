# How every library of the project is made: emberfold_library(NAME SOURCES … HEADERS … LINKS …).

set(EMBERFOLD_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wold-style-cast -Wnon-virtual-dtor
  -Woverloaded-virtual -Wdouble-promotion -Wformat=2 -Wnull-dereference)

# At -O3 g++ 12 sees null pointers and overlaps inside the standard library where there are none; the dev preset (-O2) keeps them on.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13 AND CMAKE_BUILD_TYPE STREQUAL "Release")
  list(REMOVE_ITEM EMBERFOLD_WARNINGS -Wnull-dereference)
  list(APPEND EMBERFOLD_WARNINGS -Wno-restrict)
endif()

# clang takes double{f} for an implicit promotion, and its -Wconversion holds -Wsign-conversion, unlike g++'s.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  list(REMOVE_ITEM EMBERFOLD_WARNINGS -Wdouble-promotion)
  list(APPEND EMBERFOLD_WARNINGS -Wno-sign-conversion)
endif()

function(emberfold_compile_options target)
  target_compile_options(${target} PRIVATE ${EMBERFOLD_WARNINGS} -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC
    $<$<BOOL:${EMBERFOLD_WERROR}>:-Werror> $<$<BOOL:${EMBERFOLD_NATIVE}>:-march=native>)
endfunction()

# emberfold_unity(<target> <n>): compiles up to n sources of a target at once, so that headers and templates that they
# share are read and compiled once. Sources of one unit share their anonymous namespaces: their names must not clash.
function(emberfold_unity target n)
  if(EMBERFOLD_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${n})
    target_compile_options(${target} PRIVATE -Wno-shadow)  # another source's names
  endif()
endfunction()

function(emberfold_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(emberfold_${name} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
  add_library(emberfold::${name} ALIAS emberfold_${name})
  set_target_properties(emberfold_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  emberfold_compile_options(emberfold_${name})
  emberfold_unity(emberfold_${name} 16)
  emberfold_precompile(emberfold_${name})
  target_compile_features(emberfold_${name} PUBLIC cxx_std_20)
  target_include_directories(emberfold_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/emberfold>)
  target_link_libraries(emberfold_${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  if(EMBERFOLD_INSTALL)
    install(TARGETS emberfold_${name} EXPORT emberfold-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    # Headers keep their folders: #include "sketch/rendering/render.hpp" holds in the tree and when installed.
    file(RELATIVE_PATH room ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    foreach(header IN LISTS ARG_HEADERS)
      get_filename_component(folder ${header} DIRECTORY)
      install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/emberfold/${room}/${folder})
    endforeach()
  endif()
endfunction()

# What most sources include, compiled once for all targets that take part in emberfold_precompile().
set(EMBERFOLD_PRECOMPILED <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory>
  <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <tuple> <utility> <vector>
  <Eigen/Dense> <nlohmann/json.hpp> <opencv2/core.hpp> <opencv2/imgproc.hpp>)

# emberfold_precompile(<target> [<header>]): lets a target use the precompiled headers, with one more header or without.
# A compiler uses them only where its flags are the same: all code is position-independent.
function(emberfold_precompile target)
  if(NOT EMBERFOLD_PCH)
    return()
  endif()
  string(MAKE_C_IDENTIFIER "emberfold_precompiled${ARGN}" owner)
  if(NOT TARGET ${owner})
    set(source ${PROJECT_BINARY_DIR}/${owner}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "// Owns precompiled headers.\n")
    add_library(${owner} OBJECT ${source})
    target_link_libraries(${owner} PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json opencv_core opencv_imgproc)
    target_include_directories(${owner} PRIVATE ${PROJECT_SOURCE_DIR})
    emberfold_compile_options(${owner})
    target_precompile_headers(${owner} PRIVATE ${EMBERFOLD_PRECOMPILED} ${ARGN})
    emberfold_see_through(${owner})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
  emberfold_see_through(${target})
endfunction()

# Lets ccache see through precompiled headers.
function(emberfold_see_through target)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>
    $<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>)
endfunction()
