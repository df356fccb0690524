# SPDX-License-Identifier: MIT
# The machine code of the run-time library, with constants and unwind tables, stays below a limit.
# SIZE, LIBRARY, LIMIT: bytes
execute_process(COMMAND "${SIZE}" -t "${LIBRARY}" OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
if(NOT table MATCHES "\n *([0-9]+)[ \t]+([0-9]+)[ \t]+([0-9]+)[^\n]*TOTALS")
    message(FATAL_ERROR "no total in: ${table}")
endif()
set(text ${CMAKE_MATCH_1})
math(EXPR data "${CMAKE_MATCH_2} + ${CMAKE_MATCH_3}")
message("${text} bytes of code and constants, ${data} of data")
if(text GREATER LIMIT)
    message(FATAL_ERROR "more than ${LIMIT}:\n${table}")
endif()
