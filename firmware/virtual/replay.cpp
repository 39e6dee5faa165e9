// Runs one fuzzer input from standard input: for compilers without a fuzzer, and to debug a finding.
#include <stdint.h>
#include <stdio.h>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int main() {
  static uint8_t input[1 << 20];
  return LLVMFuzzerTestOneInput(input, fread(input, 1, sizeof input, stdin));
}
