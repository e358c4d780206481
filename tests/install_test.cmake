# The installed tree can be moved: install, rename, and run a study with a figure from where nothing of the build tree
# is near. Called with -DBUILD=, -DPREFIX= (scratch) and -DSTUDY=.
file(REMOVE_RECURSE ${PREFIX} ${PREFIX}-moved)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${PREFIX} ${PREFIX}-moved)
execute_process(COMMAND ${PREFIX}-moved/bin/lunid doctor WORKING_DIRECTORY / OUTPUT_VARIABLE doctor
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT doctor MATCHES "stdlib +${PREFIX}-moved/share/lunid/stdlib")
  message(FATAL_ERROR "the moved tree does not use its own stdlib:\n${doctor}")
endif()
execute_process(COMMAND ${PREFIX}-moved/bin/lunid run ${STUDY} --out ${PREFIX}-moved/out WORKING_DIRECTORY /
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT EXISTS ${PREFIX}-moved/out/block.png)
  message(FATAL_ERROR "no figure was drawn by the moved tree")
endif()
