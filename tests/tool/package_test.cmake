# cmake -DBUILD_DIR= -DWORK_DIR= -DCONSUMER_DIR= -DGENERATOR= -P package_test.cmake
# Installs BUILD_DIR into an empty prefix, then configures, builds and runs the consumer against it, with and without the precompute.
file(REMOVE_RECURSE ${WORK_DIR})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${status}:\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
foreach(components "core\;compute" "core\;scene\;precompute\;compute\;standalone")
  string(MAKE_C_IDENTIFIER "${components}" name)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${CONSUMER_DIR} -B ${WORK_DIR}/${name} -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix "-DRELUME_COMPONENTS=${components}")
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/${name})
  run(${WORK_DIR}/${name}/consumer)
endforeach()
