# Installs Raylab from BUILD_DIR, builds the program outside against it, renders SCENE and checks agreement.
# cmake -D BUILD_DIR=… -D SOURCE_DIR=… -D SCENE=… -D GENERATOR=… -D BUILD_TYPE=… -P run.cmake
set(work ${BUILD_DIR}/plugin-test)
set(picture ${work}/picture.exr)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${work}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/my-agreement)
run(${work}/build/my-render ${SCENE} --accel grid --spp 1 --width 32 --height 32 -o ${picture})
if(NOT EXISTS ${picture})
  message(FATAL_ERROR "no picture was written")
endif()
