# SPDX-License-Identifier: GPL-3.0-or-later
# gmsh's C++ interface as the target Gmsh::Gmsh: Debian's package brings no CMake files.
find_path(GMSH_INCLUDE_DIR gmsh.h)
find_library(GMSH_LIBRARY gmsh)
mark_as_advanced(GMSH_INCLUDE_DIR GMSH_LIBRARY)

if(GMSH_INCLUDE_DIR)
  file(STRINGS ${GMSH_INCLUDE_DIR}/gmsh.h version_line REGEX "#define GMSH_API_VERSION +\"")
  string(REGEX REPLACE ".*\"([0-9.]+).*\"" "\\1" GMSH_VERSION "${version_line}")
  unset(version_line)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Gmsh REQUIRED_VARS GMSH_LIBRARY GMSH_INCLUDE_DIR VERSION_VAR GMSH_VERSION)

if(Gmsh_FOUND AND NOT TARGET Gmsh::Gmsh)
  add_library(Gmsh::Gmsh UNKNOWN IMPORTED)
  set_target_properties(Gmsh::Gmsh PROPERTIES IMPORTED_LOCATION ${GMSH_LIBRARY}
                                              INTERFACE_INCLUDE_DIRECTORIES ${GMSH_INCLUDE_DIR})
endif()
