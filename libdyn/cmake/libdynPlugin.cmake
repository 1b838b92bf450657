# SPDX-License-Identifier: BSD-2-Clause
# libdyn_add_joint_plugin(NAME SOURCES... [OUTPUT_DIRECTORY DIR] [LINK_LIBRARIES LIBRARIES...]) builds a plugin of joint types in the layout that
# libdyn expects: NAME.so for every processor, and beside it avx2/NAME.so and avx512/NAME.so, which libdyn prefers where the processor supports
# them. Their targets are NAME_avx2 and NAME_avx512; libdyn_plugin_instruction_sets lists the suffixes.

# The function calls this macro again, because a project may call the function in directories that do not see the variables of this file.
macro(libdyn_plugin_settings)
  set(libdyn_plugin_instruction_sets)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set(libdyn_plugin_instruction_sets avx2 avx512)
  endif()
  get_property(libdyn_native_set GLOBAL PROPERTY libdyn_native_set)
  if(libdyn_native_set)
    set(libdyn_plugin_instruction_sets ${libdyn_native_set})
    list(REMOVE_ITEM libdyn_plugin_instruction_sets baseline)
  endif()
  set(libdyn_options_avx2 -march=x86-64-v3)
  set(libdyn_options_avx512 -march=x86-64-v4)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # gcc 12 warns about its own intrinsics (gcc bug 105593).
    list(APPEND libdyn_options_avx512 -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
endmacro()
libdyn_plugin_settings()

function(libdyn_add_joint_plugin name)
  libdyn_plugin_settings()
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "OUTPUT_DIRECTORY" "LINK_LIBRARIES")
  if(NOT arg_OUTPUT_DIRECTORY)
    set(arg_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  endif()
  # A shared object linked with -ffast-math makes the thread that loads it flush denormal numbers to zero. Code compiled with it mishandles NaN.
  if("${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${CMAKE_BUILD_TYPE}}" MATCHES "-ffast-math|-Ofast|-funsafe-math-optimizations|-ffinite-math-only")
    message(FATAL_ERROR "libdyn_add_joint_plugin(${name}): plugins must not be built with ${CMAKE_MATCH_0}: it changes what the whole process computes")
  endif()
  foreach(isa "" ${libdyn_plugin_instruction_sets})
    if(isa)
      set(target ${name}_${isa})
    else()
      set(target ${name})
    endif()
    add_library(${target} MODULE ${arg_UNPARSED_ARGUMENTS})
    target_link_libraries(${target} PRIVATE libdyn::sdk ${arg_LINK_LIBRARIES})
    set_target_properties(${target} PROPERTIES
      PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${arg_OUTPUT_DIRECTORY}/${isa}
      CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math ${libdyn_options_${isa}})
    if(isa)
      target_compile_options(${target} PRIVATE -ffp-contract=fast)
    else()
      # Functions of configurations are called from this file. Fused products, which -march=native would bring, make difference(q, q) other than zero.
      target_compile_options(${target} PRIVATE -ffp-contract=off)
    endif()
  endforeach()
endfunction()
