# SPDX-License-Identifier: GPL-3.0-or-later
# Folder = namespace = target: `geometry/base` is the target pneuma_geometry_base, alias pneuma::geometry::base.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(PNEUMA_CCACHE ccache)
if(PNEUMA_CCACHE)
  # Names relative to the base folder: another clone finds the same objects (with -g its own: debuggers want its sources).
  # A folder's absolute name on a command line (-DTOP="/home/...") is a miss there.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
                                  CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_ABSSTDERR=1 ${PNEUMA_CCACHE})
endif()

# g++ 12 reports -Wrestrict falsely for "literal" + std::string at -O3 (GCC bug 105651)
set(PNEUMA_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wno-restrict -Werror)

# Precompiled headers, one set shared by all targets (a third of the build time). NO_PRECOMPILED for targets whose
# foreign libraries add macros of their own, which would invalidate it.
function(pneuma_precompile name)
  file(WRITE ${CMAKE_BINARY_DIR}/${name}.cpp "")
  add_library(${name} STATIC ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_compile_options(${name} PRIVATE ${PNEUMA_WARNINGS})
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

function(_pneuma_common target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE ${PNEUMA_WARNINGS})
  if(NOT ARG_NO_PRECOMPILED)
    target_link_libraries(${target} PRIVATE Eigen3::Eigen fmt::fmt)
    target_precompile_headers(${target} REUSE_FROM pneuma_precompiled)
  endif()
endfunction()

# pneuma_library(SOURCES a.cpp ... [LINKS public targets ...] [PRIVATE_LINKS foreign libraries ...] [NO_PRECOMPILED]):
# the library of this folder.
function(pneuma_library)
  cmake_parse_arguments(ARG "NO_PRECOMPILED" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE "/" "_" name ${folder})
  string(REPLACE "/" "::" alias ${folder})
  add_library(pneuma_${name} STATIC ${ARG_SOURCES})
  add_library(pneuma::${alias} ALIAS pneuma_${name})
  _pneuma_common(pneuma_${name})
  target_link_libraries(pneuma_${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
endfunction()

# pneuma_program(NAME SOURCES ... LINKS ... [NO_PRECOMPILED]): an executable in bin/.
function(pneuma_program name)
  cmake_parse_arguments(ARG "NO_PRECOMPILED" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  _pneuma_common(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
  set_property(GLOBAL APPEND PROPERTY PNEUMA_PROGRAMS ${name})
endfunction()
