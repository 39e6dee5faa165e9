// What the board remembers without power: how often it was started, and its name.
#ifndef BEATRIX_MEGA_MEMORY_H
#define BEATRIX_MEGA_MEMORY_H

namespace beatrix {
namespace mega {

// Counts this start, and has stored it when it returns: a number that was told once is never told again.
void count_start();
// Writes one byte of a name that is to be stored, if the memory is not busy. From the main loop.
void work_on_memory();

}  // namespace mega
}  // namespace beatrix

#endif
