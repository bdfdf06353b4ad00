#include <zwang/bench/timing/instruction_set.h>

#include <unistd.h>
#include <utility>

// Compiled for the first x86-64 (CMakeLists.txt): this must run everywhere.

namespace zwang {
namespace {

unsigned of_this_cpu() {
  unsigned there = 0;
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("sse4.2")) there |= sse4_2;
  if (__builtin_cpu_supports("avx")) there |= avx;
  if (__builtin_cpu_supports("avx2")) there |= avx2;
  if (__builtin_cpu_supports("fma")) there |= fma;
  if (__builtin_cpu_supports("bmi2")) there |= bmi2;
  if (__builtin_cpu_supports("avx512f")) there |= avx512f;
  if (__builtin_cpu_supports("avx512dq")) there |= avx512dq;
  if (__builtin_cpu_supports("avx512vl")) there |= avx512vl;
#else
  there = built_for;
#endif
  return there;
}

// Before the constructors of other sources, which may use anything.
__attribute__((constructor(101))) void look() {
  const std::string names = lacking(built_for, of_this_cpu());
  if (names.empty()) return;
  const std::string line = "This program was built for " + names +
                           ", which this CPU lacks: build it with -DZWANG_NATIVE=OFF and the flags of the oldest node "
                           "(docs/campaigns.md)\n";
  if (write(STDERR_FILENO, line.data(), line.size()) < 0) _exit(4);
  _exit(3);
}

}  // namespace

std::string lacking(unsigned wanted, unsigned there) {
  constexpr std::pair<unsigned, const char*> names[] = {
      {sse4_2, "SSE4.2"}, {avx, "AVX"},          {avx2, "AVX2"},          {fma, "FMA"},
      {bmi2, "BMI2"},     {avx512f, "AVX-512F"}, {avx512dq, "AVX-512DQ"}, {avx512vl, "AVX-512VL"}};
  std::string text;
  for (const auto& [bit, name] : names)
    if (wanted & ~there & bit) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

void check_instruction_set() {}

}  // namespace zwang
