# Installs the core of the build folder BUILD into an empty folder, builds plugin/core/examples there
# and runs it; then configures it on the sources, as FetchContent does.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(status)
    message(FATAL_ERROR "${ARGN}: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(folder ${BUILD}/example)
file(REMOVE_RECURSE ${folder})
set(configure ${CMAKE_COMMAND} -S ${SOURCE}/plugin/core/examples -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX} -DEigen3_DIR=${EIGEN} -Dmuparser_DIR=${MUPARSER})
run(${CMAKE_COMMAND} --install ${BUILD} --component library --prefix ${folder}/installed)
run(${configure} -B ${folder}/build -DCMAKE_PREFIX_PATH=${folder}/installed)
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/smooth_icosahedron)
if(NOT output MATCHES "^spike: 2\\.85317 -> ")
  message(FATAL_ERROR "the example prints: ${output}")
endif()
message(STATUS "${output}")
run(${configure} -B ${folder}/fetched -DSPECTRAL_MESH_SOURCE=${SOURCE})
