# SPDX-License-Identifier: Apache-2.0
# A stage is a folder of core or hal, or of a folder there (onboard/control): its sources, and the stages
# whose types it may use. The same list is what the layering check (tools/proof/check_layers.py) holds the includes to.

# hp_stage(<layer> <name> [DEPENDS <stage>...])
#   makes the library hardpack_<layer>_<name> from every .cpp of the current folder's <name>/
function(hp_stage layer name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  string(REPLACE "/" "_" target hardpack_${layer}_${name})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(sources)
    add_library(${target} OBJECT ${sources})
    target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
    if(HARDPACK_JOIN_STAGES)
      hp_joined(${target})
    endif()
    if(TARGET counted_stage)
      target_link_libraries(${target} PRIVATE counted_stage)
      target_precompile_headers(${target} REUSE_FROM counted_stage_headers)
    else()
      target_link_libraries(${target} PRIVATE hardpack_core_options)
    endif()
    set_property(GLOBAL APPEND PROPERTY hardpack_${layer}_objects $<TARGET_OBJECTS:${target}>)
  endif()
  set_property(GLOBAL APPEND PROPERTY hardpack_${layer}_stages "${name}: ${ARG_DEPENDS}")
endfunction()

# hp_layer(<layer> [DEPENDS <target>...])
#   joins the stages declared so far to the static library hardpack_<layer>, alias hardpack::<layer>
function(hp_layer layer)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  get_property(objects GLOBAL PROPERTY hardpack_${layer}_objects)
  add_library(hardpack_${layer} STATIC ${objects})
  add_library(hardpack::${layer} ALIAS hardpack_${layer})
  set_target_properties(hardpack_${layer} PROPERTIES EXPORT_NAME ${layer} LINKER_LANGUAGE CXX)
  target_compile_features(hardpack_${layer} PUBLIC cxx_std_20)
  target_include_directories(hardpack_${layer} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/hardpack>)
  # Inline functions of the headers must give the same bits in a user's build: a linker may keep the
  # user's copy of one for the whole program.
  target_compile_options(hardpack_${layer} PUBLIC -ffp-contract=off)
  target_link_libraries(hardpack_${layer} PUBLIC ${ARG_DEPENDS})
endfunction()
