# One interface target carries what every target of ours is compiled with. Dependencies never see it.
add_library(penumbra_options INTERFACE)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

set(PENUMBRA_SANITIZERS "" CACHE STRING "Comma-separated -fsanitize list, e.g. address,undefined")

target_compile_features(penumbra_options INTERFACE cxx_std_20)
target_include_directories(penumbra_options INTERFACE ${PROJECT_SOURCE_DIR})

# No contraction: a texel is blocked or it is not, and scalar, SIMD and CUDA code must agree on which.
# A multiply-add fused on one side only would move silhouettes by a rounding error.
target_compile_options(penumbra_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -Werror -ffp-contract=off>)

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False positives of g++ 12 on std::string concatenation (gcc bug 105651).
  target_compile_options(penumbra_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict -Wno-stringop-overflow -Wno-array-bounds>)
endif()

# Kernels are compiled once per instruction set. SSSE3 and SSE4 are for processors from before 2013, which the baseline
# serves as well; sets beyond AVX3 (bits below its own) have nothing that our kernels use. On ARM nothing is left out.
option(PENUMBRA_ALL_TARGETS "Compile kernels for every instruction set that Highway knows" OFF)
if(NOT PENUMBRA_ALL_TARGETS)
  target_compile_definitions(penumbra_options INTERFACE
    "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|(HWY_AVX3-1))")
endif()

if(PENUMBRA_SANITIZERS)
  # One instruction set: the kernels' source is the same for all, and instrumented it compiles slowly.
  target_compile_definitions(penumbra_options INTERFACE HWY_COMPILE_ONLY_STATIC)
  target_compile_options(penumbra_options INTERFACE
    -fsanitize=${PENUMBRA_SANITIZERS} -fno-sanitize-recover=all -fno-omit-frame-pointer
    # g++ mistakes instrumented std::function for uninitialised.
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>
    # Highway's emulated vectors convert NaN as processors do; g++ does not look at such casts either.
    $<$<COMPILE_LANG_AND_ID:CXX,Clang>:-fno-sanitize=float-cast-overflow>)
  target_link_options(penumbra_options INTERFACE -fsanitize=${PENUMBRA_SANITIZERS})
endif()

# With paths relative to the checkout, another checkout finds what this one compiled. The sloppiness is what ccache's
# manual asks for with precompiled headers; no source of ours uses __TIME__ or __DATE__.
find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# clang writes the time of every header into a precompiled one and refuses it when they differ, as ccache's copies do.
target_compile_options(penumbra_options INTERFACE
  "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")

# penumbra_library(name SOURCES ... LINK ...): a static library with our options.
function(penumbra_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC penumbra_options ${ARG_LINK})
endfunction()

# penumbra_precompile(target <header>...): headers that many sources of a target read are parsed once: these and the given
# ones. Only headers of libraries: paths of this checkout would keep the compiler cache from serving another one. None that
# defines objects, such as CLI11's validators: every source would compile them anew, for seconds. Sources still include what
# they use; the preset `lint` reads them without (CMAKE_DISABLE_PRECOMPILE_HEADERS).
function(penumbra_precompile target)
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <fmt/format.h> <fmt/ranges.h>
    <fstream> <functional> <glm/glm.hpp> <map> <memory> <numeric> <optional> <set> <span> <string> <vector> ${ARGN})
endfunction()

# penumbra_optimise_less(target REGEX): sources that match run for milliseconds and compile for many seconds. Never for
# what is timed or makes a result.
function(penumbra_optimise_less target regex)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "${regex}")
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O1>")
endfunction()

# penumbra_bench(name source library): times parts of a library alone. Built with the tests, or when asked for by name.
function(penumbra_bench name source library)
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE ${library} benchmark::benchmark)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  if(NOT PENUMBRA_TESTS)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()
