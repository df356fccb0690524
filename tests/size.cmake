# SPDX-License-Identifier: MIT
# The machine code of the run-time library stays below a limit.
# SIZE, LIBRARY, LIMIT: bytes
execute_process(COMMAND "${SIZE}" -A "${LIBRARY}" OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
set(code 0)
set(constants 0)
string(REGEX MATCHALL "\n\\.[^ \n]+ +[0-9]+" lines "${table}")
foreach(line ${lines})
    if(line MATCHES "\n\\.text[^ ]* +([0-9]+)")
        math(EXPR code "${code} + ${CMAKE_MATCH_1}")
    elseif(line MATCHES "\n\\.(rodata|data)[^ ]* +([0-9]+)")
        math(EXPR constants "${constants} + ${CMAKE_MATCH_2}")
    endif()
endforeach()
message("${code} bytes of machine code, ${constants} of constants")
if(code LESS 10000 OR code GREATER LIMIT)
    message(FATAL_ERROR "the limit is ${LIMIT}:\n${table}")
endif()
