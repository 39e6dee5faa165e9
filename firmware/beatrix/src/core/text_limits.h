// Shortens text motions to the limits: the old protocol cannot refuse them with a reason.
#ifndef BEATRIX_TEXT_LIMITS_H
#define BEATRIX_TEXT_LIMITS_H

#include "limits.h"

namespace beatrix {

static const Warning NOT_SHORTENED = Warning(0);

// Move `target` back on the line from `start` to the first limit, and return the warning for this limit, or
// NOT_SHORTENED. If `start` is beyond a limit, a motion may stay beyond it but not go further.
Warning shorten_to_limits(const int32_t start[ARMS], int32_t target[ARMS]);

}  // namespace beatrix

#endif
