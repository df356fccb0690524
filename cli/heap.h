// SPDX-License-Identifier: GPL-3.0-or-later
// The heap of this process, made for what the commands do: few, large arrays, written once from end to end.
//
// A page that is written for the first time costs more than a microsecond on a virtual machine, and looking
// up small pages of a large world costs time at every cache miss. So address space is set apart at the start,
// large pages are asked for it, and what is freed there stays for what comes next. It is one for all threads
// unless that is asked for.
#ifndef CLI_HEAP_H
#define CLI_HEAP_H

#include <stdint.h>

/// Sets address space apart, no memory: 2 GiB, or a quarter of what the process may have if that is less.
/// What does not fit in takes large arrays from the system, and gives them back. Without glibc nothing
/// happens.
void cli_heap_prepare(void);

/// Threads get heaps of their own: for work that takes memory often, in small pieces (exact numbers), where
/// they would wait for each other. To be called before there are any.
void cli_heap_divide(void);

/// Takes so much memory for the heap, as far as there is space set apart, so that nothing waits for it later.
/// For measuring: the host of a virtual machine may have to be asked for memory, at a cost that is neither
/// the program's nor the same from run to run. To be called when the heap has been prepared.
void cli_heap_touch(uint64_t bytes);

/// Gives back what is free, and the space: before another process is made of this one, or a limit is set. To
/// be prepared again after it.
void cli_heap_trim(void);

#endif
