// Optimises for speed where the Arduino IDE optimises for size: the first include of every source.
//
// With link-time optimisation, inlining functions that are called once makes the planner's tick 28 % slower.
#ifdef ARDUINO
#pragma GCC optimize("O3", "no-tree-pre", "no-inline-functions-called-once")
#endif
