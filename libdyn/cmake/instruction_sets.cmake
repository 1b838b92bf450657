# SPDX-License-Identifier: BSD-2-Clause
# DYN_INSTRUCTION_SETS chooses the instruction sets that kernels and plugins are compiled for. Plugins are always built for the baseline too, which
# every processor of this architecture has.
#   all     baseline, avx2, avx512, and kernels without packs (scalar) for tests; packages are built with this value
#   native  the best set of this machine's processor
# The value native reduces libdyn_plugin_instruction_sets. DYN_KERNEL_SETS lists the modules of kernels; DYN_KERNEL_SET_NAMES is this list as text.
set(DYN_INSTRUCTION_SETS all CACHE STRING "Instruction sets: all, or native")
set_property(CACHE DYN_INSTRUCTION_SETS PROPERTY STRINGS all native)

# DYN_BEST_SET is the best set of this machine's processor, by the compiler's macros. It must agree with processorHas() in
# libdyn/src/joint/processor.cpp.
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=native -dM -E -x c++ /dev/null OUTPUT_VARIABLE macros ERROR_QUIET)
set(needed_avx2 AVX2 FMA)
set(needed_avx512 AVX512F AVX512DQ AVX512BW AVX512VL AVX512CD FMA)
set(DYN_BEST_SET baseline)
foreach(isa ${libdyn_plugin_instruction_sets})
  set(has_all TRUE)
  foreach(feature ${needed_${isa}})
    if(NOT macros MATCHES "__${feature}__")
      set(has_all FALSE)
    endif()
  endforeach()
  if(has_all)
    set(DYN_BEST_SET ${isa})
  endif()
endforeach()

if(DYN_INSTRUCTION_SETS STREQUAL "all")
  set(DYN_KERNEL_SETS baseline ${libdyn_plugin_instruction_sets} scalar)
elseif(DYN_INSTRUCTION_SETS STREQUAL "native")
  set(DYN_KERNEL_SETS ${DYN_BEST_SET})
  set_property(GLOBAL PROPERTY libdyn_native_set ${DYN_BEST_SET})
  libdyn_plugin_settings()
else()
  message(FATAL_ERROR "DYN_INSTRUCTION_SETS=${DYN_INSTRUCTION_SETS}: it is all or native")
endif()
list(JOIN DYN_KERNEL_SETS " " DYN_KERNEL_SET_NAMES)
