# Installs Raylab from BUILD_DIR, draws the results of BENCH_DIR with it, builds the program outside against
# it by find_package and by pkg-config, renders SCENE and checks agreement.
# cmake -D BUILD_DIR=… -D SOURCE_DIR=… -D SCENE=… -D GENERATOR=… -D BUILD_TYPE=… -D BENCH_DIR=…
#       -D COMPILER=… -P run.cmake
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

foreach(page IN ITEMS man/man1/raylab-render.1 bash-completion/completions/raylab-render
        zsh/site-functions/_raylab-render fish/vendor_completions.d/raylab-render.fish)
  if(NOT EXISTS ${work}/prefix/share/${page})
    message(FATAL_ERROR "share/${page} was not installed")
  endif()
endforeach()

# The installed scripts are all there, and are the ones that run.
file(GLOB_RECURSE scripts RELATIVE ${BENCH_DIR} ${BENCH_DIR}/report/*.py ${BENCH_DIR}/report/*.json
     ${BENCH_DIR}/report/*.html ${BENCH_DIR}/peers/*.py)
file(GLOB_RECURSE report ${work}/prefix/share/raylab/report/report.py)
cmake_path(GET report PARENT_PATH installed)
foreach(script IN LISTS scripts)
  if(NOT EXISTS ${installed}/../${script})
    message(FATAL_ERROR "${script} was not installed")
  endif()
endforeach()
file(WRITE "${report}" "import sys; open(sys.argv[1] + '/drawn', 'w').close()")
file(COPY ${BENCH_DIR}/results/results.json DESTINATION ${work}/results)
run(${work}/prefix/bin/raylab-bench report --python python3 ${work}/results)
if(NOT EXISTS ${work}/results/drawn)
  message(FATAL_ERROR "the charts were drawn by another script than the installed one")
endif()

run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${work}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/my-agreement)
run(${work}/build/my-render ${SCENE} --accel grid --spp 1 --width 32 --height 32 -o ${picture})
# What takes no triangle test is measured once: a row for each of five kinds of rays, below the header.
run(${work}/build/my-bench rays ${SCENE} --accel grid,careless --rays 200 --checked 50 --repeats 1 --out ${work}/bench)
file(STRINGS ${work}/bench/results.csv rows)
list(LENGTH rows count)
if(NOT count EQUAL 11)
  message(FATAL_ERROR "two accelerators without a triangle test gave ${count} lines, not 11")
endif()
if(NOT EXISTS ${picture})
  message(FATAL_ERROR "no picture was written")
endif()

# The same by pkg-config alone.
file(GLOB_RECURSE pc ${work}/prefix/raylab.pc)
cmake_path(GET pc PARENT_PATH pc_folder)
set(ENV{PKG_CONFIG_PATH} ${pc_folder})
run(sh -c "'${COMPILER}' -std=c++20 agreement_main.cpp my_accelerator.cpp -o ${work}/agreement-by-pkg-config \
    $(pkg-config --cflags --static --libs raylab)" WORKING_DIRECTORY ${SOURCE_DIR})
run(${work}/agreement-by-pkg-config)
