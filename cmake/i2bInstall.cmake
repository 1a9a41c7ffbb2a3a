# Filled by the packaging part: install, export, find_package(i2b).
