# emberfold_wasm_program(<out.cpp> <source>...): compiles sources to one WebAssembly program, and writes a source that
# holds it as emberfold::apps::motion_page_program(). The program is empty without EMBERFOLD_WASM, and
# `emberfold motion page` says so. The compiler is clang 16 or 19 with its linker, its libc++ for wasm32 and wasi-libc.
if(EMBERFOLD_WASM)
  find_program(EMBERFOLD_WASM_CXX NAMES clang++-19 clang++-16 DOC "clang for wasm32, of a version whose libc++ is there, too")
  string(REGEX MATCH "[0-9]+$" wasm_version "${EMBERFOLD_WASM_CXX}")
  find_program(EMBERFOLD_WASM_LD NAMES wasm-ld-${wasm_version} NO_CACHE)
  set(wasm_llvm /usr/lib/llvm-${wasm_version})
  file(GLOB wasm_builtins ${wasm_llvm}/lib/clang/${wasm_version}/lib/wasi/libclang_rt.builtins-wasm32.a)
  if(NOT (EMBERFOLD_WASM_LD AND wasm_builtins AND EXISTS ${wasm_llvm}/lib/wasm32-wasi/libc++.a AND EXISTS /usr/lib/wasm32-wasi/libc.a))
    message(FATAL_ERROR "EMBERFOLD_WASM needs clang 16 or 19, its linker, its libc++ for wasm32 and wasi-libc: 'scripts/deps wasm' installs them")
  endif()
  find_program(wasm_ccache ccache NO_CACHE)
endif()

function(emberfold_wasm_program out)
  set(unit "// Made by cmake/wasm.cmake.\n#include \"apps/motion_page/motion_page_assets.hpp\"\n\n")
  set(wasm ${CMAKE_CURRENT_BINARY_DIR}/motion_page.wasm)
  if(NOT EMBERFOLD_WASM)
    file(CONFIGURE OUTPUT ${out} CONTENT
      "${unit}std::span<const unsigned char> emberfold::apps::motion_page_program() {\n  return {};\n}\n")
    return()
  endif()
  # Headers of libraries that are for any machine, away from those of this one.
  set(include ${CMAKE_CURRENT_BINARY_DIR}/wasm/include)
  file(MAKE_DIRECTORY ${include})
  find_path(wasm_opencv opencv2/core/types.hpp PATHS ${OpenCV_INCLUDE_DIRS} NO_DEFAULT_PATH NO_CACHE)
  find_path(wasm_boost boost/version.hpp NO_CACHE)
  find_path(wasm_json nlohmann/json.hpp NO_CACHE)
  file(CREATE_LINK ${wasm_opencv}/opencv2 ${include}/opencv2 SYMBOLIC)
  file(CREATE_LINK ${wasm_boost}/boost ${include}/boost SYMBOLIC)
  file(CREATE_LINK ${wasm_json}/nlohmann ${include}/nlohmann SYMBOLIC)
  set(flags --target=wasm32-wasi -std=c++20 -O2 -ffp-contract=off -fignore-exceptions -fvisibility=hidden -w
    -nostdinc++ -isystem ${wasm_llvm}/include/wasm32-wasi/c++/v1 -isystem /usr/include/wasm32-wasi
    -I${PROJECT_SOURCE_DIR} -I${CMAKE_CURRENT_SOURCE_DIR}/motion_page/wasm/standins -isystem ${include}
    -DJSON_HAS_FILESYSTEM=0 -DJSON_HAS_EXPERIMENTAL_FILESYSTEM=0)
  set(objects "")
  foreach(source ${ARGN})
    string(REPLACE "/" "_" object ${source})
    set(object ${CMAKE_CURRENT_BINARY_DIR}/wasm/${object}.o)
    add_custom_command(OUTPUT ${object}
      COMMAND ${wasm_ccache} ${EMBERFOLD_WASM_CXX} ${flags} -MD -MF ${object}.d -c ${PROJECT_SOURCE_DIR}/${source} -o ${object}
      DEPENDS ${PROJECT_SOURCE_DIR}/${source} DEPFILE ${object}.d COMMENT "Building WebAssembly object ${source}" VERBATIM)
    list(APPEND objects ${object})
  endforeach()
  add_custom_command(OUTPUT ${wasm}
    COMMAND ${EMBERFOLD_WASM_CXX} --target=wasm32-wasi -mexec-model=reactor -nostdlib -fuse-ld=${EMBERFOLD_WASM_LD} -o ${wasm} ${objects}
      /usr/lib/wasm32-wasi/crt1-reactor.o -L${wasm_llvm}/lib/wasm32-wasi -L/usr/lib/wasm32-wasi -lc++ -lc++abi -lc ${wasm_builtins}
      -Wl,--gc-sections -Wl,--strip-all
    DEPENDS ${objects} VERBATIM)
  file(CONFIGURE OUTPUT ${out} CONTENT "${unit}__asm__(
    \".section .rodata\\n\"
    \".balign 16\\n\"
    \"emberfold_motion_page_begin: .incbin \\\"${wasm}\\\"\\n\"
    \"emberfold_motion_page_end: .byte 0\\n\"
    \".globl emberfold_motion_page_begin, emberfold_motion_page_end\\n\"
    \".previous\\n\");
extern \"C\" const unsigned char emberfold_motion_page_begin[], emberfold_motion_page_end[];

std::span<const unsigned char> emberfold::apps::motion_page_program() {
  return {emberfold_motion_page_begin, emberfold_motion_page_end};
}
")
  set_source_files_properties(${out} PROPERTIES OBJECT_DEPENDS ${wasm})
endfunction()
