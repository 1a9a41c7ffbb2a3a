# Language, warnings, sanitizers and the compiler cache; one place for the whole tree.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Build type" FORCE)
endif()
# Machines since 2013 have AVX2; results are the same with and without it. The program refuses to start where it lacks
# what it was built for. Fused operations stay out: Eigen would use them.
set(I2B_ARCH_DEFAULT "")
include(CheckCXXSourceRuns)
check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"x86-64-v3\") ? 0 : 1; }" I2B_BUILDS_ON_X86_64_V3)
if(I2B_BUILDS_ON_X86_64_V3)
  set(I2B_ARCH_DEFAULT "x86-64-v3")
endif()
set(I2B_ARCH "${I2B_ARCH_DEFAULT}" CACHE STRING "Instruction set (-march) of the build; empty: the compiler's own, for machines without AVX2")
# Contraction to fused operations would make results depend on the instruction set.
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1 -DNDEBUG")
add_library(i2b_settings INTERFACE)
# Nobody here asks errno for a root's fault, or traps one: without either, roots are one instruction. Nobody replaces a function of
# a shared library made of this by another: without that, functions of a file call each other directly. Results are the same.
target_compile_options(i2b_settings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-semantic-interposition)
if(I2B_ARCH)
  target_compile_options(i2b_settings INTERFACE -march=${I2B_ARCH} -mno-fma)
endif()
if(I2B_WARNINGS_AS_ERRORS)
  target_compile_options(i2b_settings INTERFACE -Werror)
endif()
if(I2B_SANITIZE)
  target_compile_options(i2b_settings INTERFACE -fsanitize=${I2B_SANITIZE} -fno-omit-frame-pointer)
  if(I2B_SANITIZE MATCHES "undefined")
    # Optimising what these checks insert into OpenVDB's templates takes the compiler minutes and 2 GB a file: less of it, and
    # no checks for null and misaligned pointers and dynamic types, the first of which address checks find too. Thread checks
    # stay at -O2: their suppressions count on TBB's loops being inlined.
    set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1 -DNDEBUG")
    target_compile_options(i2b_settings INTERFACE -fno-sanitize=null,alignment,vptr)
  endif()
  target_link_options(i2b_settings INTERFACE -fsanitize=${I2B_SANITIZE})
endif()
find_program(I2B_CCACHE ccache)
if(I2B_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${I2B_CCACHE})
endif()
# ccache and precompiled headers agree only when the compiler does not look at the header's time stamp.
add_compile_options(-fpch-preprocess)
