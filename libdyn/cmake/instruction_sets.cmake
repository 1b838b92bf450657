# DYN_INSTRUCTION_SETS: what kernels and plugins are compiled for beside the baseline, which every processor of this architecture has.
#   all     avx2, avx512 and, for tests, scalar: what packages want
#   native  the best that this machine's processor has: what a build for oneself wants, in half the time
# Sets libdyn_plugin_instruction_sets, and DYN_SCALAR_TABLE to "scalar" if the kernels are wanted number by number, too.
set(DYN_INSTRUCTION_SETS all CACHE STRING "Instruction sets beside the baseline: all, or native")
set_property(CACHE DYN_INSTRUCTION_SETS PROPERTY STRINGS all native)
set(DYN_SCALAR_TABLE)
if(DYN_INSTRUCTION_SETS STREQUAL "all")
  set(DYN_SCALAR_TABLE scalar)
elseif(DYN_INSTRUCTION_SETS STREQUAL "native")
  # What the compiler takes the processor for says what it has.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=native -dM -E -x c++ /dev/null OUTPUT_VARIABLE macros ERROR_QUIET)
  set(libdyn_plugin_instruction_sets)
  if(macros MATCHES "__AVX512F__" AND macros MATCHES "__AVX512DQ__" AND macros MATCHES "__AVX512BW__" AND macros MATCHES "__AVX512VL__" AND
     macros MATCHES "__AVX512CD__" AND macros MATCHES "__FMA__")
    set(libdyn_plugin_instruction_sets avx512)
  elseif(macros MATCHES "__AVX2__" AND macros MATCHES "__FMA__")
    set(libdyn_plugin_instruction_sets avx2)
  endif()
else()
  message(FATAL_ERROR "DYN_INSTRUCTION_SETS=${DYN_INSTRUCTION_SETS}: it is all or native")
endif()
