# SPDX-License-Identifier: MIT
file(READ "${PROGRAM}" program)
file(READ "${README}" readme)
string(FIND "${readme}" "${program}" place)
if(place EQUAL -1)
    message(FATAL_ERROR "README.md does not hold tests/example.c as it is; copy it there again")
endif()
