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
  target_compile_options(${target} PRIVATE ${EMBERFOLD_WARNINGS} -ffp-contract=off
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
  emberfold_unity(emberfold_${name} 8)
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

# emberfold_precompile(<target> <header>...): compiles these headers once for all of the target's sources.
function(emberfold_precompile target)
  if(NOT EMBERFOLD_PCH)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN})
  # What ccache needs to see through them.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>
    $<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>)
endfunction()
