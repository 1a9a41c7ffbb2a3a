# An installed tree answers find_package(i2b) with the target i2b::i2b.
include(CMakePackageConfigHelpers)
install(TARGETS i2b_library EXPORT i2bTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET i2b)
  install(TARGETS i2b RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/i2b DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")
set(i2b_config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/i2b)
install(EXPORT i2bTargets NAMESPACE i2b:: DESTINATION ${i2b_config_folder})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/i2bConfig.cmake.in ${PROJECT_BINARY_DIR}/i2bConfig.cmake
                              INSTALL_DESTINATION ${i2b_config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/i2bConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/i2bConfig.cmake ${PROJECT_BINARY_DIR}/i2bConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/i2bFindOpenVDB.cmake
        DESTINATION ${i2b_config_folder})
