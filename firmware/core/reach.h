// How far along a straight line the arms may go for a program that knows no limits.
#ifndef BEATRIX_REACH_H
#define BEATRIX_REACH_H

#include "guard.h"

namespace beatrix {

static const Warning WITHIN_REACH = Warning(0);

// Moves `target` back on the line from `start` as far as the limits ask for, and says which did; WITHIN_REACH: none.
// Where `start` lies beyond a limit, all ways that lead no further beyond it are open.
Warning shorten(const int32_t start[ARMS], int32_t target[ARMS]);

}  // namespace beatrix

#endif
