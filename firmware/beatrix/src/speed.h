// Optimises for speed where the Arduino IDE optimises for size: the first include of every source.
//
// Functions that are called once are not inlined: with link-time optimisation, inlining them makes a tick 28 % slower.
#ifdef ARDUINO
#pragma GCC optimize("O3", "no-tree-pre", "no-inline-functions-called-once")
#endif
