# FindMeshLab: the headers and the core library of MeshLab 2025.07, for which there is no
# development package. MeshLab exists in two precisions, and takes plugins of its own only.
#
# Variables that may be set:
#   MESHLAB_SOURCE_DIR   a checkout of MeshLab 2025.07 with its submodules (the folder that holds
#                        src/common). Unset: taken from Debian's source package, checked by hash,
#                        into build/meshlab-source of this project.
#   MESHLAB_LIBRARY_DIR  the folder of a double-precision meshlab-common, or of the Python package
#                        pymeshlab. Unset: pymeshlab in the interpreter Python3_EXECUTABLE.
#   MESHLAB_FLOAT_LIBRARY_DIR  Windows: the folder of a single-precision meshlab-common.lib.
#
# Targets, each to build a plugin for one of the hosts:
#   MeshLab::double  2025.07d: pymeshlab, and MeshLab's releases of double precision. Linked to the
#                    core library, because Python does not show a library that it has loaded to
#                    those that it loads later.
#   MeshLab::float   2025.07: the usual MeshLab, Debian's too. Without a core library: the program
#                    has loaded its own by the time it loads a plugin, which finds the symbols there.
#                    Windows links every symbol to a library: there it needs one, or is not defined.
find_package(Qt5 5.15 REQUIRED COMPONENTS Core Gui Widgets Xml OpenGL)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/MeshLabLibrary.cmake)

if(NOT MESHLAB_SOURCE_DIR)
  set(_meshlab_fetched ${PROJECT_SOURCE_DIR}/build/meshlab-source)
  execute_process(
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/fetch_meshlab_source.sh ${_meshlab_fetched}
    RESULT_VARIABLE _meshlab_fetch_result)
  if(_meshlab_fetch_result)
    message(FATAL_ERROR
      "MeshLab's headers could not be fetched from Debian's source package (see above). "
      "Give a checkout of MeshLab 2025.07 with its submodules: -DMESHLAB_SOURCE_DIR=<folder>.")
  endif()
  set(MESHLAB_SOURCE_DIR ${_meshlab_fetched} CACHE PATH
      "Checkout of MeshLab 2025.07 (the folder that holds src/common)" FORCE)
endif()

if(NOT MESHLAB_LIBRARY_DIR)
  find_package(Python3 3.10 REQUIRED COMPONENTS Interpreter)
  execute_process(
    COMMAND ${Python3_EXECUTABLE} -c
            "import importlib.util as u, pathlib as p; print(p.Path(u.find_spec('pymeshlab').origin).parent.as_posix())"
    OUTPUT_VARIABLE _meshlab_library_dir OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  set(MESHLAB_LIBRARY_DIR "${_meshlab_library_dir}" CACHE PATH
      "Folder of MeshLab's core library, or of pymeshlab" FORCE)
endif()

find_path(MeshLab_INCLUDE_DIR common/plugins/interfaces/filter_plugin.h
          PATHS ${MESHLAB_SOURCE_DIR}/src NO_DEFAULT_PATH)
find_path(MeshLab_VCG_INCLUDE_DIR vcg/complex/complex.h
          PATHS ${MESHLAB_SOURCE_DIR}/src/vcglib NO_DEFAULT_PATH)
find_path(GLEW_INCLUDE_DIR GL/glew.h)  # which MeshLab's mesh_model.h includes
find_meshlab_library(MeshLab_LIBRARY "${MESHLAB_LIBRARY_DIR}")

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MeshLab
  REQUIRED_VARS MeshLab_LIBRARY MeshLab_INCLUDE_DIR MeshLab_VCG_INCLUDE_DIR GLEW_INCLUDE_DIR
  FAIL_MESSAGE "MeshLab 2025.07 not found: set MESHLAB_SOURCE_DIR (checkout with submodules) and \
MESHLAB_LIBRARY_DIR (folder of meshlab-common, or install pymeshlab==2025.7.post1), and install GLEW's \
headers")

# meshlab_host(<scalar> <version> [<library>])
function(meshlab_host scalar version)
  if(ARGC GREATER 2)
    add_library(MeshLab::${scalar} UNKNOWN IMPORTED)
    set_target_properties(MeshLab::${scalar} PROPERTIES IMPORTED_LOCATION ${ARGV2})
  else()
    add_library(MeshLab::${scalar} INTERFACE IMPORTED)
  endif()
  target_compile_definitions(MeshLab::${scalar} INTERFACE
    MESHLAB_VERSION=${version} MESHLAB_SCALAR=${scalar})
  target_link_libraries(MeshLab::${scalar} INTERFACE MeshLab::headers)
endfunction()

if(MeshLab_FOUND AND NOT TARGET MeshLab::double)
  add_library(MeshLab::headers INTERFACE IMPORTED)
  # As SYSTEM headers: their warnings are not ours to mend.
  target_include_directories(MeshLab::headers SYSTEM INTERFACE
    ${MeshLab_INCLUDE_DIR} ${MeshLab_VCG_INCLUDE_DIR} ${GLEW_INCLUDE_DIR}
    ${MESHLAB_SOURCE_DIR}/src/external/easyexif-1.0)
  target_link_libraries(MeshLab::headers INTERFACE
    Qt5::Core Qt5::Gui Qt5::Widgets Qt5::Xml Qt5::OpenGL Eigen3::Eigen)

  meshlab_host(double 2025.07d ${MeshLab_LIBRARY})
  if(NOT WIN32)
    meshlab_host(float 2025.07)
  elseif(MESHLAB_FLOAT_LIBRARY_DIR)
    find_meshlab_library(MeshLab_FLOAT_LIBRARY "${MESHLAB_FLOAT_LIBRARY_DIR}")
    meshlab_host(float 2025.07 ${MeshLab_FLOAT_LIBRARY})
  endif()
endif()
