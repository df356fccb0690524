# SPDX-License-Identifier: MIT
# Installs the run-time library, moves the tree, builds the program of README.md against it with nothing but
# pkg-config, and runs it: with the shared library, and with the static one alone.
# BUILD, SOURCE, COMPILER, CXX_COMPILER: or empty, FLAGS, PKG_CONFIG, LIBDIR: below the prefix, SEEDS: a program that writes worlds
set(tree "${BUILD}/tests/installed")
file(REMOVE_RECURSE "${tree}" "${tree}-first")
execute_process(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${tree}-first" --component run
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME "${tree}-first" "${tree}")
file(MAKE_DIRECTORY "${tree}/worlds")
execute_process(COMMAND "${SEEDS}" "${tree}/worlds" OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(GLOB world "${tree}/worlds/cubes-4.enf")
set(ENV{PKG_CONFIG_PATH} "${tree}/${LIBDIR}/pkgconfig")
separate_arguments(flags NATIVE_COMMAND "${FLAGS}")

# All headers at once, in strict C11 and, where there is a compiler for it, C++.
file(GLOB headers RELATIVE "${tree}/include" "${tree}/include/enfilade/*.h")
set(text)
foreach(header ${headers})
    string(APPEND text "#include <${header}>\n")
endforeach()
file(WRITE "${tree}/all.c" "${text}int main(void) { return ENF_VERSION_MAJOR; }\n")
execute_process(COMMAND "${COMPILER}" ${flags} -std=c11 -Wall -Wextra -pedantic-errors -Werror -fsyntax-only
                        "-I${tree}/include" "${tree}/all.c" COMMAND_ERROR_IS_FATAL ANY)
if(CXX_COMPILER)
    execute_process(COMMAND "${CXX_COMPILER}" -std=c++11 -Wall -Wextra -pedantic-errors -Werror -fsyntax-only
                            "-I${tree}/include" -x c++ "${tree}/all.c" COMMAND_ERROR_IS_FATAL ANY)
endif()

foreach(kind shared static)
    set(static)
    if(kind STREQUAL static)
        file(GLOB shared "${tree}/${LIBDIR}/*.so*")
        file(REMOVE ${shared})
        set(static --static)
    endif()
    execute_process(COMMAND "${PKG_CONFIG}" --cflags --libs ${static} enfilade-run
                    OUTPUT_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(words NATIVE_COMMAND "${words}")
    execute_process(COMMAND "${COMPILER}" ${flags} -std=c11 "${SOURCE}/tests/example.c" -o "${tree}/example-${kind}"
                            ${words} "-Wl,-rpath,${tree}/${LIBDIR}" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND "${tree}/example-${kind}" ${world} 0.5 0.5 0.4
                    OUTPUT_VARIABLE answer COMMAND_ERROR_IS_FATAL ANY)
    message("${kind}: ${answer}")
    if(NOT answer MATCHES "^the eye is in cell [0-9]+, in air\ncell [0-9]+ through portal -1: -1.00 to 1.00.*\ncell [0-9]+ through portal [0-9]+: ")
        message(FATAL_ERROR "not an answer")
    endif()
endforeach()
