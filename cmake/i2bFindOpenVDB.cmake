# OpenVDB ships a find module instead of a package file. Debian's Imath, which it pulls in, names a Python library
# that is in no package OpenVDB needs and prints nine lines about it at every configure: only warnings get through.
if(NOT TARGET OpenVDB::openvdb)
  set(i2b_module_path "${CMAKE_MODULE_PATH}")
  set(i2b_log_level "${CMAKE_MESSAGE_LOG_LEVEL}")
  list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(OpenVDB REQUIRED)
  set(CMAKE_MESSAGE_LOG_LEVEL "${i2b_log_level}")
  set(CMAKE_MODULE_PATH "${i2b_module_path}")
endif()
