# SPDX-License-Identifier: Apache-2.0
# install(): headers, libraries and a package file, so that find_package(hardpack) works. Headers
# keep their paths below include/hardpack: #include "core/autonomy/planner.h".
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hardpack)
set(installed_layers core hal config)
set(installed_targets hardpack_core hardpack_hal)
if(TARGET hardpack_port_linux)
  list(APPEND installed_layers port_linux)
  list(APPEND installed_targets hardpack_port_linux)
endif()

foreach(layer IN LISTS installed_layers)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${layer} COMPONENT development
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hardpack FILES_MATCHING PATTERN "*.h")
endforeach()
install(TARGETS ${installed_targets} EXPORT hardpackTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT hardpackTargets NAMESPACE hardpack:: DESTINATION ${package_dir}
  COMPONENT development)
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/cmake/hardpackConfig.cmake.in
  ${PROJECT_BINARY_DIR}/hardpackConfig.cmake INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hardpackConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hardpackConfig.cmake
  ${PROJECT_BINARY_DIR}/hardpackConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT development)
