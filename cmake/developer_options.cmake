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
  target_compile_options(penumbra_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()

if(PENUMBRA_SANITIZERS)
  # One instruction set: the kernels' source is the same for all, and instrumented it compiles slowly.
  target_compile_definitions(penumbra_options INTERFACE HWY_COMPILE_ONLY_STATIC)
  target_compile_options(penumbra_options INTERFACE
    -fsanitize=${PENUMBRA_SANITIZERS} -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>) # g++ mistakes instrumented std::function for uninitialised
  target_link_options(penumbra_options INTERFACE -fsanitize=${PENUMBRA_SANITIZERS})
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# penumbra_library(name SOURCES ... LINK ...): a static library with our options.
function(penumbra_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC penumbra_options ${ARG_LINK})
endfunction()
