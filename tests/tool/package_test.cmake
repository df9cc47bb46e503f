# cmake -DBUILD_DIR= -DWORK_DIR= -DCONSUMER_DIR= -DMAKE_SCENE= -DGENERATOR= -P package_test.cmake
# Installs BUILD_DIR into an empty prefix, then configures, builds and runs the consumers (C++ and C) against it, with and without the
# precompute. Both light models that the installed program made.
file(REMOVE_RECURSE ${WORK_DIR})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${status}:\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${MAKE_SCENE} two_rooms -o ${WORK_DIR}/scene.glb)
run(${WORK_DIR}/prefix/bin/relume precompute ${WORK_DIR}/scene.glb -o ${WORK_DIR}/scene.relume --texel-size 0.4 --cluster-size 1
    --quality 64)
run(${WORK_DIR}/prefix/bin/relume precompute ${CONSUMER_DIR}/facing_squares.gltf -o ${WORK_DIR}/squares.relume --texel-size 0.25
    --cluster-size 0.25 --sensors ${CONSUMER_DIR}/middle_of_floor.csv)
foreach(components "core\;compute" "core\;scene\;precompute\;compute\;standalone")
  string(MAKE_C_IDENTIFIER "${components}" name)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${CONSUMER_DIR} -B ${WORK_DIR}/${name} -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix "-DRELUME_COMPONENTS=${components}")
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/${name})
  run(${WORK_DIR}/${name}/consumer ${WORK_DIR}/scene.relume)
  run(${WORK_DIR}/${name}/c_renderer ${WORK_DIR}/scene.relume ${WORK_DIR}/squares.relume)
endforeach()
