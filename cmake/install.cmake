# Headers, libraries, programs and the CMake package. Each component has its own export file, so that a renderer that wants core and
# compute needs neither Embree nor tinygltf.
include(CMakePackageConfigHelpers)

set(RELUME_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/relume)
set(RELUME_HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/relume)

set(RELUME_INSTALLED_COMPONENTS core compute standalone)
if(RELUME_PRECOMPUTE)
  list(APPEND RELUME_INSTALLED_COMPONENTS scene precompute)
endif()
foreach(component ${RELUME_INSTALLED_COMPONENTS})
  install(TARGETS relume_${component} EXPORT relume-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT relume-${component} NAMESPACE relume:: DESTINATION ${RELUME_PACKAGE_DIR})
endforeach()

set(only_headers FILES_MATCHING PATTERN "*.h")
install(DIRECTORY src/core DESTINATION ${RELUME_HEADER_DIR} ${only_headers})
install(DIRECTORY compute DESTINATION ${RELUME_HEADER_DIR} ${only_headers})
install(DIRECTORY kernels/shared DESTINATION ${RELUME_HEADER_DIR}/kernels ${only_headers})
# For shaders of the renderer.
install(FILES kernels/include/relume_sample_lightmap.glsl kernels/include/relume_sample_probes.glsl DESTINATION ${RELUME_HEADER_DIR}/kernels)
if(RELUME_PRECOMPUTE)
  install(DIRECTORY src/scene DESTINATION ${RELUME_HEADER_DIR} ${only_headers} PATTERN "import" EXCLUDE)
  install(DIRECTORY precompute DESTINATION ${RELUME_HEADER_DIR} ${only_headers})
endif()
if(RELUME_TOOL)
  install(TARGETS relume RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(cmake/relume-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/relume-config.cmake
  INSTALL_DESTINATION ${RELUME_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/relume-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/relume-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/relume-config-version.cmake
  DESTINATION ${RELUME_PACKAGE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
