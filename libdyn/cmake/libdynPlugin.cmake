# libdyn_add_joint_plugin(NAME SOURCES...): a shared object of joint types, built as libdyn wants it.
function(libdyn_add_joint_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE libdyn::sdk)
  set_target_properties(${name} PROPERTIES
    PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${name} PRIVATE -fno-math-errno -fno-trapping-math)
endfunction()
