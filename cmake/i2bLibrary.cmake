# i2b::i2b: the objects of all stages in one static library. What the stages link publicly (packages, not each
# other) becomes what the library links, so a new dependency of a stage needs no second entry here.
get_property(stages GLOBAL PROPERTY I2B_STAGES)
add_library(i2b_library STATIC)
add_library(i2b::i2b ALIAS i2b_library)
set_target_properties(i2b_library PROPERTIES OUTPUT_NAME i2b EXPORT_NAME i2b LINKER_LANGUAGE CXX)
target_compile_features(i2b_library PUBLIC cxx_std_20)
target_include_directories(i2b_library PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
foreach(stage ${stages})
  target_sources(i2b_library PRIVATE $<TARGET_OBJECTS:${stage}>)
  get_target_property(links ${stage} INTERFACE_LINK_LIBRARIES)
  foreach(link ${links})
    # Private links of an object library appear as $<LINK_ONLY:...>: the settings, which are not for users.
    if(NOT link IN_LIST stages AND NOT link MATCHES "LINK_ONLY|NOTFOUND|^i2b_")
      list(APPEND packages ${link})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES packages)
target_link_libraries(i2b_library PUBLIC ${packages})
