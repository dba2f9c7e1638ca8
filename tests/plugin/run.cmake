# Installs Raylab from BUILD_DIR, draws RESULTS with the installed programs, builds the program outside against
# them, renders SCENE and checks agreement.
# cmake -D BUILD_DIR=… -D SOURCE_DIR=… -D SCENE=… -D GENERATOR=… -D BUILD_TYPE=… -D RESULTS=… -P run.cmake
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

# The charts are drawn by the installed scripts: the second time by one that says so.
file(COPY ${RESULTS} DESTINATION ${work}/results)
run(${work}/prefix/bin/raylab-bench report ${work}/results)
if(NOT EXISTS ${work}/results/index.html)
  message(FATAL_ERROR "no index.html was written")
endif()
file(GLOB_RECURSE script ${work}/prefix/share/raylab/report.py)
file(WRITE "${script}" "import sys; open(sys.argv[1] + '/drawn', 'w').close()")
run(${work}/prefix/bin/raylab-bench report ${work}/results)
if(NOT EXISTS ${work}/results/drawn)
  message(FATAL_ERROR "the charts were drawn by another script than the installed one")
endif()

run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${work}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/my-agreement)
run(${work}/build/my-render ${SCENE} --accel grid --spp 1 --width 32 --height 32 -o ${picture})
if(NOT EXISTS ${picture})
  message(FATAL_ERROR "no picture was written")
endif()
