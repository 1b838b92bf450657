# SPDX-License-Identifier: BSD-2-Clause
# Rules of `cmake --install`. The installed tree can be moved: libraries and the command find each other by $ORIGIN, and plugins lie beside the
# library.
include(CMakePackageConfigHelpers)

set(DYN_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/libdyn)
install(TARGETS libdyn dyn_sdk libdyn_geometry libdyn_parsers EXPORT libdynTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development)
if(TARGET libdyn_urdfdom)
  install(TARGETS libdyn_urdfdom EXPORT libdynTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development)
endif()
install(EXPORT libdynTargets NAMESPACE libdyn:: DESTINATION ${DYN_CMAKE_DIR} COMPONENT development)
install(DIRECTORY libdyn/include/dyn libdyn/sdk/dyn_sdk parsers/include/dyn DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(TARGETS dyn_standard LIBRARY DESTINATION ${DYN_PLUGIN_DIR} COMPONENT plugins)
install(FILES LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
if(TARGET dyn)
  install(DIRECTORY libdyn/schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/libdyn COMPONENT tools)
  install(TARGETS dyn RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
  if(TARGET dyn_pages)
    install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT tools)
  endif()
endif()
foreach(isa ${DYN_KERNEL_SETS})
  install(TARGETS dyn_kernels_${isa} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/libdyn/kernels COMPONENT runtime)
endforeach()
foreach(isa ${libdyn_plugin_instruction_sets})
  install(TARGETS dyn_standard_${isa} LIBRARY DESTINATION ${DYN_PLUGIN_DIR}/${isa} COMPONENT plugins)
endforeach()

if(TARGET libdyn_python)
  install(TARGETS libdyn_python LIBRARY DESTINATION ${DYN_PYTHON_DIR}/libdyn COMPONENT python)
  install(DIRECTORY libdyn/python/libdyn/ ${PROJECT_BINARY_DIR}/python/libdyn/_core DESTINATION ${DYN_PYTHON_DIR}/libdyn COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
endif()

configure_package_config_file(libdyn/cmake/libdynConfig.cmake.in ${PROJECT_BINARY_DIR}/libdynConfig.cmake INSTALL_DESTINATION ${DYN_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/libdynConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/libdynConfig.cmake ${PROJECT_BINARY_DIR}/libdynConfigVersion.cmake libdyn/cmake/libdynPlugin.cmake
  DESTINATION ${DYN_CMAKE_DIR} COMPONENT development)

# pkg-config files give paths relative to themselves.
file(RELATIVE_PATH DYN_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
function(dyn_pkg_config DYN_PC_NAME DYN_PC_LIBRARY DYN_PC_REQUIRES DYN_PC_DESCRIPTION)
  configure_file(libdyn/cmake/libdyn.pc.in ${PROJECT_BINARY_DIR}/${DYN_PC_NAME}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${DYN_PC_NAME}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
dyn_pkg_config(libdyn dyn eigen3 "Kinematics and dynamics of robots; joints come from plugins")
dyn_pkg_config(libdyn-geometry dyn_geometry libdyn "Collision and distance, for libdyn")
dyn_pkg_config(libdyn-parsers dyn_parsers libdyn "Robots from URDF, for libdyn")
